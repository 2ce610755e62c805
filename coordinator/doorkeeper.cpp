#include "coordinator/doorkeeper.h"

#include <sys/stat.h>

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "coordinator/client/farm_log.h"
#include "core/base/status_macros.h"
#include "core/base/user_file.h"

namespace irsig {
namespace {

constexpr std::uint64_t kMostListBytes = 16'000'000;  // some 10^5 revocations
constexpr std::size_t kMostCallers = 10000;
constexpr double kListIsLookedAtEvery_s = 1;
constexpr double kWarningsAreLookedForEvery_s = 60;
constexpr double kDay_s = 86400, kHour_s = 3600;
// At most so many lines of refusals are logged per period; further refusals are counted.
constexpr std::uint64_t kMostRefusalLines = 20;
constexpr double kRefusalLinesIn_s = 60;

// Returns a stamp that changes when the file is replaced or written to.
std::string stamp_of(const std::string& path) {
  struct stat info {};
  if (stat(path.c_str(), &info) != 0) return "";
  return absl::StrCat(info.st_dev, " ", info.st_ino, " ", info.st_size, " ", info.st_mtim.tv_sec,
                      " ", info.st_mtim.tv_nsec);
}

}  // namespace

absl::StatusOr<std::unique_ptr<Doorkeeper>> Doorkeeper::make(std::shared_ptr<const TlsIdentity> tls,
                                                             const Visitors& visitors,
                                                             std::string crl_path,
                                                             Clock unix_clock) {
  if (!tls && !crl_path.empty())
    return absl::InvalidArgumentError(
        "--tls-crl is for ports with TLS: --tls-cert, --tls-key and --tls-ca");
  std::unique_ptr<Doorkeeper> out(
      new Doorkeeper(std::move(tls), visitors, std::move(crl_path), std::move(unix_clock)));
  const double now = out->unix_clock_();
  RETURN_IF_ERROR(out->read_revocations(now));
  out->log_warnings(now);
  return out;
}

absl::Status Doorkeeper::read_revocations(double now_unix_s) {
  crl_looked_unix_s_ = now_unix_s;
  if (crl_path_.empty()) return absl::OkStatus();
  const std::string stamp = stamp_of(crl_path_);
  if (!stamp.empty() && stamp == crl_stamp_) return absl::OkStatus();
  const auto text = read_user_file(crl_path_, kMostListBytes);
  auto list = text.ok() ? revoked_serials(*text, tls_->ca) : text.status();
  if (!list.ok()) {
    crl_problem_ = absl::StrCat(crl_path_, ": ", std::string(list.status().message()));
    return absl::InvalidArgumentError(crl_problem_);
  }
  crl_problem_.clear();
  if (!crl_stamp_.empty())
    log_line(LogLevel::info, {}, "revoked certificates were read anew: {} in {}", list->size(),
             crl_path_);
  crl_stamp_ = stamp;
  revoked_ = *std::move(list);
  return absl::OkStatus();
}

absl::Status Doorkeeper::look(const std::string& pem, std::string_view call,
                              const std::set<Role>& enough, std::string& who) {
  const double now = unix_clock_();
  if (pem.empty()) return absl::UnauthenticatedError("no certificate was shown");
  auto caller = callers_.find(pem);
  if (caller == callers_.end()) {
    auto facts = certificate_facts(pem);
    if (!facts.ok()) return absl::UnauthenticatedError(facts.status().message());
    if (callers_.size() >= kMostCallers) callers_.clear();
    caller = callers_.emplace(pem, Caller{*std::move(facts), now}).first;
    warned_unix_s_ = -1e9;  // it may be soon at its end
  }
  caller->second.seen_unix_s = now;
  const CertificateFacts& facts = caller->second.facts;
  who = absl::StrCat("\"", facts.name, "\" (certificate ", facts.serial_hex, ")");
  if (now - crl_looked_unix_s_ >= kListIsLookedAtEvery_s)
    static_cast<void>(
        read_revocations(now));  // what cannot be read is a warning; the old list stays
  if (revoked_.contains(facts.serial_hex))
    return absl::UnauthenticatedError(
        absl::StrCat("the certificate \"", facts.name, "\" was revoked by its authority"));
  if (now >= facts.valid_until_unix_s)
    return absl::UnauthenticatedError(
        absl::StrCat("the certificate \"", facts.name, "\" has expired"));
  const bool may = std::any_of(enough.begin(), enough.end(),
                               [&](Role role) { return facts.roles.contains(role); });
  if (may) return absl::OkStatus();
  return absl::PermissionDeniedError(
      absl::StrCat(std::string(call), " needs the role ", role_list(enough, "or"),
                   "; the certificate \"", facts.name, "\" has ",
                   facts.roles.empty() ? "none (`irsig ca issue --role` gives some)"
                                       : role_list(facts.roles, "and")));
}

absl::Status Doorkeeper::admit(const grpc::ServerContextBase& context, std::string_view call,
                               const std::set<Role>& enough) {
  if (!tls_) return absl::OkStatus();
  const auto visitor = visitors_.find(context.peer());
  if (!visitor) return absl::CancelledError("the connection has ended");
  const std::lock_guard lock(mutex_);
  std::string who = "a caller without a certificate";
  const absl::Status status = look(visitor->certificate, call, enough, who);
  const double now = unix_clock_();
  if (!status.ok()) log_refusal(call, absl::StrCat(who, " from ", visitor->address), status, now);
  if (now - warned_unix_s_ >= kWarningsAreLookedForEvery_s) log_warnings(now);
  return status;
}

void Doorkeeper::log_refusal(std::string_view call, const std::string& who, const absl::Status& why,
                             double now_unix_s) {
  if (now_unix_s - refusals_since_unix_s_ >= kRefusalLinesIn_s) {
    if (refusals_untold_ > 0)
      log_line(LogLevel::warn, {}, "refused: {} more calls", refusals_untold_);
    refusals_since_unix_s_ = now_unix_s;
    refusals_ = refusals_untold_ = 0;
  }
  if (++refusals_ <= kMostRefusalLines) {
    log_line(LogLevel::warn, {}, "refused: {} by {}: {}", call, who, std::string(why.message()));
  } else {
    ++refusals_untold_;
  }
}

std::vector<std::string> Doorkeeper::find_warnings(double now_unix_s) {
  std::vector<std::string> out;
  if (!tls_) return out;
  out = running_out(*tls_, now_unix_s);
  std::set<std::string> told;
  for (const auto& [pem, caller] : callers_) {
    if (now_unix_s - caller.seen_unix_s > kHour_s) continue;
    const std::string end = running_out(caller.facts, now_unix_s);
    if (!end.empty())
      told.insert(absl::StrCat("the certificate \"", caller.facts.name, "\" of a caller ", end));
  }
  constexpr std::size_t kMostTold = 20;
  for (const std::string& line : told) {
    if (out.size() >= kMostTold) break;
    out.push_back(line);
  }
  if (!crl_problem_.empty())
    out.push_back(
        absl::StrCat("the revocation list cannot be read, the last one goes on: ", crl_problem_));
  return out;
}

void Doorkeeper::log_warnings(double now_unix_s) {
  warned_unix_s_ = now_unix_s;
  std::erase_if(logged_, [&](const auto& one) { return now_unix_s - one.second >= kDay_s; });
  for (const std::string& warning : find_warnings(now_unix_s))
    if (logged_.emplace(warning, now_unix_s).second) log_line(LogLevel::warn, {}, warning);
}

std::vector<std::string> Doorkeeper::warnings() {
  const std::lock_guard lock(mutex_);
  return find_warnings(unix_clock_());
}

}  // namespace irsig
