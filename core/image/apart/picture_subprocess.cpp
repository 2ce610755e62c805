// Images are decoded in a process of its own (docs/decisions/0021): OpenEXR may crash on them, and
// OpenImageIO is slow to load.
#include "core/image/apart/picture_subprocess.h"

#include <cstring>
#include <type_traits>
#include <utility>

#include "core/base/run_subprocess.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

constexpr std::string_view kTasks = "irsig pictures 2\n", kAnswers = "irsig answers 1\n",
                           kRefused = "irsig none 1\n";

class Writer {
 public:
  explicit Writer(std::string_view head) : out_(head) {}

  template <typename T>
  void number(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    out_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  template <typename Values>
  void list(const Values& values) {
    number(std::uint64_t{values.size()});
    out_.append(reinterpret_cast<const char*>(values.data()),
                values.size() * sizeof(typename Values::value_type));
  }
  [[nodiscard]] std::string take() { return std::move(out_); }

 private:
  std::string out_;
};

// Takes fields from the front; once one is not there, none of the others is.
class Reader {
 public:
  explicit Reader(std::string_view left) : left_(left) {}

  template <typename T>
  void number(T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    good_ = good_ && left_.size() >= sizeof value;
    if (!good_) return;
    std::memcpy(&value, left_.data(), sizeof value);
    left_.remove_prefix(sizeof value);
  }
  void flag(bool& value) {
    std::uint8_t byte = 0;
    number(byte);
    value = byte != 0;
  }
  template <typename Values>
  void list(Values& values) {
    using T = typename Values::value_type;
    std::uint64_t count = 0;
    number(count);
    good_ = good_ && count <= left_.size() / sizeof(T);
    if (!good_) return;
    values.resize(count);
    if (count > 0) std::memcpy(values.data(), left_.data(), count * sizeof(T));
    left_.remove_prefix(count * sizeof(T));
  }
  [[nodiscard]] bool good() const { return good_; }
  [[nodiscard]] bool more() const { return good_ && !left_.empty(); }

 private:
  std::string_view left_;
  bool good_ = true;
};

absl::StatusOr<std::vector<PictureAnswer>> ask(const std::string& program,
                                               std::span<const PictureTask> tasks) {
  const std::string bytes = encode_tasks(tasks);
  ASSIGN_OR_RETURN(const auto reply, run_subprocess(program, {std::to_string(bytes.size())}, bytes,
                                                    apart_limits(bytes.size())));
  auto answers = decode_answers(reply);
  if (answers.ok() && answers->size() != tasks.size())
    return absl::InternalError("irsig-picture answers another number of images than it was given");
  if (absl::IsDataLoss(answers.status()))
    return absl::InternalError("irsig-picture gave no complete answer");
  return answers;
}

}  // namespace

std::string picture_program() { return program_beside("irsig-picture"); }

absl::StatusOr<std::vector<PictureAnswer>> read_pictures_subprocess(
    const std::string& program, std::span<const PictureTask> tasks) {
  if (tasks.empty()) return std::vector<PictureAnswer>();
  auto answers = ask(program, tasks);
  if (answers.ok() || !absl::IsInvalidArgument(answers.status())) return answers;
  if (tasks.size() == 1) {
    std::vector<PictureAnswer> one(1);
    one[0].damage = std::string(answers.status().message());
    return one;
  }
  // One of the pictures ended the process: halves find it.
  std::vector<PictureAnswer> out;
  const std::size_t middle = tasks.size() / 2;
  for (const auto half : {tasks.first(middle), tasks.subspan(middle)}) {
    auto some = read_pictures_subprocess(program, half);
    if (!some.ok()) return some;
    for (PictureAnswer& answer : *some) out.push_back(std::move(answer));
  }
  return out;
}

std::string encode_tasks(std::span<const PictureTask> tasks) {
  Writer out(kTasks);
  for (const PictureTask& task : tasks) {
    out.number(task.most_px);
    for (const bool flag : {task.paint, task.pixels, task.seen.has_value()})
      out.number(static_cast<std::uint8_t>(flag));
    out.number(task.black_w_m2_sr);
    out.number(task.white_w_m2_sr);
    out.number(task.bits);
    const PictureTask::Seen seen = task.seen.value_or(PictureTask::Seen{});
    for (const double number :
         {seen.gain, seen.path_radiance_w_m2_sr, seen.background_radiance_w_m2_sr})
      out.number(number);
    out.list(seen.filled);
    out.list(task.exr);
  }
  return out.take();
}

absl::StatusOr<std::vector<PictureTask>> decode_tasks(std::string_view bytes) {
  const absl::Status broken = absl::DataLossError("no complete list of images");
  if (!bytes.starts_with(kTasks)) return broken;
  Reader in(bytes.substr(kTasks.size()));
  std::vector<PictureTask> out;
  while (in.more()) {
    PictureTask& task = out.emplace_back();
    bool is_seen = false;
    PictureTask::Seen seen{};
    in.number(task.most_px);
    for (bool* flag : {&task.paint, &task.pixels, &is_seen}) in.flag(*flag);
    in.number(task.black_w_m2_sr);
    in.number(task.white_w_m2_sr);
    in.number(task.bits);
    for (double* number :
         {&seen.gain, &seen.path_radiance_w_m2_sr, &seen.background_radiance_w_m2_sr})
      in.number(*number);
    in.list(seen.filled);
    in.list(task.exr);
    if (is_seen) task.seen = std::move(seen);
  }
  if (!in.good()) return broken;
  return out;
}

std::string encode_answers(const absl::StatusOr<std::vector<PictureAnswer>>& answers) {
  if (!answers.ok()) return std::string(kRefused) + std::string(answers.status().message());
  Writer out(kAnswers);
  for (const PictureAnswer& a : *answers) {
    out.list(a.damage);
    out.number(a.hottest_w_m2_sr);
    for (const std::uint32_t n : {a.width_px, a.height_px, a.shown_px, a.left_px, a.top_px,
                                  a.box_width_px, a.box_height_px})
      out.number(n);
    out.list(a.png);
    out.list(a.pixel);
  }
  return out.take();
}

absl::StatusOr<std::vector<PictureAnswer>> decode_answers(std::string_view bytes) {
  const absl::Status broken = absl::DataLossError("no complete list of answers");
  if (bytes.starts_with(kRefused))
    return absl::InvalidArgumentError(std::string(bytes.substr(kRefused.size())));
  if (!bytes.starts_with(kAnswers)) return broken;
  Reader in(bytes.substr(kAnswers.size()));
  std::vector<PictureAnswer> out;
  while (in.more()) {
    PictureAnswer& a = out.emplace_back();
    in.list(a.damage);
    in.number(a.hottest_w_m2_sr);
    for (std::uint32_t* n : {&a.width_px, &a.height_px, &a.shown_px, &a.left_px, &a.top_px,
                             &a.box_width_px, &a.box_height_px})
      in.number(*n);
    in.list(a.png);
    in.list(a.pixel);
    if (in.good() && !a.pixel.empty() &&
        a.pixel.size() != static_cast<std::size_t>(a.width_px) * a.height_px)
      return broken;
  }
  if (!in.good()) return broken;
  return out;
}

}  // namespace irsig
