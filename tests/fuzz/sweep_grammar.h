#pragma once

#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "schema/sweep.pb.h"

namespace irsig::fuzz {

// Sweep files made from the grammar (schema/sweep.proto): every key of every table may come, with
// the kinds and names that the readers know, with numbers at and beyond their bounds or another
// key's, with values of another type; tables come twice, from another file, or not at all.
class SweepGrammar {
 public:
  // sound: texts of sweep files that are accepted; parsed: others that can at least be parsed. The
  // made ones begin with them, most of them with a sound one. files: names of what lies beside.
  SweepGrammar(const std::vector<std::string>& sound, const std::vector<std::string>& parsed,
               std::vector<std::string> files);

  // Returns one text for each seed.
  [[nodiscard]] std::string make(std::uint64_t seed);

 private:
  using Message = google::protobuf::Message;
  using Field = google::protobuf::FieldDescriptor;

  std::size_t below(std::size_t end) { return static_cast<std::size_t>(random_() % end); }
  template <typename T>
  const T& one_of(const std::vector<T>& all) {
    return all[below(all.size())];
  }

  const schema::Sweep& other();
  schema::Sweep begin();
  // Puts a value into a field, or takes it away.
  void set(Message& message, const Field& field);
  void fill(Message& message, std::size_t of_four);
  void change(Message& message);
  void shrink(schema::Sweep& sweep);  // what is large takes long, and finds nothing more
  double number(const Message& message, const Field& field);
  std::uint64_t whole(const Message& message, const Field& field);
  std::string text(const Message& message, const Field& field);
  void damage(std::string& toml);

  std::mt19937_64 random_;
  std::vector<schema::Sweep> sound_, parsed_;
  std::vector<std::string> files_;
};

// A message as TOML.
[[nodiscard]] std::string toml_of(const google::protobuf::Message& message);

}  // namespace irsig::fuzz
