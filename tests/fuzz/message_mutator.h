#pragma once

#include <google/protobuf/message.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace irsig::fuzz {

// Changes a message in one to three places: a field is taken away, an element added, taken or
// doubled, a number or a text becomes one that readers trip over. The same for the same seed.
class MessageMutator {
 public:
  explicit MessageMutator(std::uint64_t seed) : random_(seed) {}

  void mutate(google::protobuf::Message& message) {
    for (std::size_t i = below(3) + 1; i > 0; --i) change(message);
  }

 private:
  using Field = google::protobuf::FieldDescriptor;

  std::size_t below(std::size_t end) { return static_cast<std::size_t>(random_() % end); }

  double number() {
    static const std::vector<double> numbers = {0,
                                                -0.0,
                                                1,
                                                -1,
                                                -5,
                                                0.5,
                                                1e-9,
                                                1e300,
                                                -1e300,
                                                4e9,
                                                17,
                                                20001,
                                                1e15,
                                                std::numeric_limits<double>::infinity(),
                                                std::nan(""),
                                                std::numeric_limits<double>::min()};
    return numbers[below(numbers.size())];
  }

  std::string text() {
    static const std::vector<std::string> texts = {"",
                                                   "x",
                                                   "..",
                                                   "/etc/passwd",
                                                   "\x1b]0;owned\x07",
                                                   std::string("\0", 1),
                                                   "\xff\xfe",
                                                   "2025-13-41T99:99:99Z",
                                                   "atmosphere",
                                                   "vacuum",
                                                   "sea",
                                                   "only",
                                                   std::string(2000, 'y')};
    return texts[below(texts.size())];
  }

  // A third of the way each time, so that no part of a deep message is left alone.
  void change(google::protobuf::Message& message) {
    const google::protobuf::Reflection& r = *message.GetReflection();
    const google::protobuf::Descriptor& type = *message.GetDescriptor();
    std::vector<const Field*> present;
    r.ListFields(message, &present);
    if (!present.empty() && below(4) > 0) {
      const Field& field = *present[below(present.size())];
      if (field.cpp_type() == Field::CPPTYPE_MESSAGE && !field.is_map() && below(8) > 0) {
        if (!field.is_repeated()) return change(*r.MutableMessage(&message, &field));
        const auto size = static_cast<std::size_t>(r.FieldSize(message, &field));
        return change(*r.MutableRepeatedMessage(&message, &field, static_cast<int>(below(size))));
      }
      return change_field(message, field);
    }
    change_field(
        message,
        *type.field(static_cast<int>(below(static_cast<std::size_t>(type.field_count())))));
  }

  void change_field(google::protobuf::Message& message, const Field& field) {
    const google::protobuf::Reflection& r = *message.GetReflection();
    if (below(6) == 0) return r.ClearField(&message, &field);
    if (field.is_repeated() && r.FieldSize(message, &field) > 0 && below(3) == 0)
      return r.RemoveLast(&message, &field);
    const bool list = field.is_repeated();
    const std::uint64_t whole = below(3) == 0 ? random_() : below(5);
    switch (field.cpp_type()) {
      case Field::CPPTYPE_DOUBLE:
        return list ? r.AddDouble(&message, &field, number())
                    : r.SetDouble(&message, &field, number());
      case Field::CPPTYPE_FLOAT: {
        const auto value = static_cast<float>(number());
        return list ? r.AddFloat(&message, &field, value) : r.SetFloat(&message, &field, value);
      }
      case Field::CPPTYPE_INT32: {
        const auto value = static_cast<std::int32_t>(whole);
        return list ? r.AddInt32(&message, &field, value) : r.SetInt32(&message, &field, value);
      }
      case Field::CPPTYPE_INT64: {
        const auto value = static_cast<std::int64_t>(whole);
        return list ? r.AddInt64(&message, &field, value) : r.SetInt64(&message, &field, value);
      }
      case Field::CPPTYPE_UINT32: {
        const auto value = static_cast<std::uint32_t>(whole);
        return list ? r.AddUInt32(&message, &field, value) : r.SetUInt32(&message, &field, value);
      }
      case Field::CPPTYPE_UINT64:
        return list ? r.AddUInt64(&message, &field, whole) : r.SetUInt64(&message, &field, whole);
      case Field::CPPTYPE_BOOL:
        return list ? r.AddBool(&message, &field, whole & 1U)
                    : r.SetBool(&message, &field, whole & 1U);
      case Field::CPPTYPE_ENUM:
        return r.SetEnumValue(&message, &field, static_cast<int>(whole & 0xffU));
      case Field::CPPTYPE_STRING:
        return list ? r.AddString(&message, &field, text()) : r.SetString(&message, &field, text());
      case Field::CPPTYPE_MESSAGE:
        if (!list) {
          r.MutableMessage(&message, &field);
        } else if (field.is_map() || r.FieldSize(message, &field) == 0) {
          r.AddMessage(&message, &field);
        } else {
          google::protobuf::Message* twin = r.AddMessage(&message, &field);
          twin->CopyFrom(r.GetRepeatedMessage(message, &field, 0));
        }
        return;
      default:
        return;
    }
  }

  std::mt19937_64 random_;
};

}  // namespace irsig::fuzz
