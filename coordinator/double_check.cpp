#include "coordinator/double_check.h"

#include <algorithm>
#include <cstdlib>

#include "absl/strings/str_cat.h"
#include "jobs/keys/expand.h"

namespace irsig {
namespace {

constexpr std::size_t kMostWanted = 1000;
constexpr std::size_t kMostDisputed = 1000;

}  // namespace

bool DoubleCheck::chosen(const JobName& job) const {
  if (share_ <= 0) return false;
  const std::string hash = sha256_hex(absl::StrCat(salt_, job.sweep_sha256, job.job_key));
  const auto number = std::strtoull(hash.substr(0, 13).c_str(), nullptr, 16);  // 52 bits
  return static_cast<double>(number) < share_ * 0x1p52;
}

void DoubleCheck::ask_for(const JobName& job, std::set<std::string> not_by) {
  if (wanted_.size() >= kMostWanted) wanted_.pop_front();
  wanted_.push_back({job, std::move(not_by)});
}

std::optional<JobName> DoubleCheck::next_for(const std::string& worker) {
  const auto found = std::find_if(wanted_.begin(), wanted_.end(), [&](const Wanted& wanted) {
    return !wanted.not_by.contains(worker);
  });
  if (found == wanted_.end()) return std::nullopt;
  JobName job = std::move(found->job);
  wanted_.erase(found);
  return job;
}

std::optional<DoubleCheck::Verdict> DoubleCheck::agrees(const JobName& job,
                                                        const std::string& content) {
  ++audited_;
  const auto disputed = others_.find(job);
  if (disputed == others_.end()) return std::nullopt;
  // Whoever differed from what was stored once may have what is stored now: a job is computed again
  // when its first worker was set aside.
  disputed->second.erase(content);
  if (disputed->second.empty()) {
    others_.erase(disputed);
    return std::nullopt;
  }
  const Verdict verdict{Verdict::Kind::kOneIsWrong, disputed->second.begin()->second};
  others_.erase(disputed);
  return verdict;
}

DoubleCheck::Verdict DoubleCheck::differs(const JobName& job, const std::string& stored_content,
                                          const std::string& stored_by, const std::string& content,
                                          const std::string& worker) {
  ++audited_;
  if (others_.size() >= kMostDisputed) others_.clear();
  auto& others = others_[job];
  if (others.contains(content) && others.at(content) != worker) {
    // Whoever agrees with what was stored is the one of another opinion now.
    others_[job] = {{stored_content, stored_by}};
    return {Verdict::Kind::kStoredIsWrong, stored_by};
  }
  const bool first = others.empty();
  others.emplace(content, worker);
  if (first) ask_for(job, {stored_by, worker});
  return {Verdict::Kind::kUndecided, ""};
}

void Stragglers::took(double seconds) {
  known_ = std::min(known_ + 1, kRemembered);
  typical_s_ += (seconds - typical_s_) / known_;
}

}  // namespace irsig
