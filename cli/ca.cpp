#include <chrono>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "cli/commands.h"
#include "cli/output_options.h"
#include "coordinator/client/authority.h"
#include "core/base/printable.h"
#include "core/base/status_macros.h"
#include "view/base/print.h"
#include "view/base/table.h"

namespace irsig {
namespace {

constexpr double kDay_s = 86400;

double now_unix_s() { return absl::ToDoubleSeconds(absl::Now() - absl::UnixEpoch()); }

CLI::Option* add_days(CLI::App& command, double& days) {
  return command.add_option("--days", days, "how long it is valid")
      ->type_name("N")
      ->capture_default_str()
      ->check(CLI::Range(1e-3, 36500.0));
}

void add_ca_init(CLI::App& ca, int& exit_code) {
  struct Options {
    std::string folder, name = "irsig farm authority";
    double days = 3650;
  };
  auto options = std::make_shared<Options>();
  auto* command = ca.add_subcommand("init", "make an authority: key, certificate, revocation list");
  command->add_option("FOLDER", options->folder, "its folder; made with mode 0700")->required();
  command->add_option("--name", options->name, "its name in certificates")->capture_default_str();
  add_days(*command, options->days);
  command->callback([=, &exit_code] {
    exit_code = report(
        make_authority(options->folder, options->name, now_unix_s(), options->days * kDay_s));
  });
}

void add_ca_issue(CLI::App& ca, int& exit_code) {
  struct Options {
    std::string folder, out = ".";
    CertificateWish wish;
    std::vector<std::string> roles;
    double days = 365;
  };
  auto options = std::make_shared<Options>();
  auto* command = ca.add_subcommand("issue", "sign a certificate: NAME.pem and NAME.key");
  command->add_option("FOLDER", options->folder, "the authority's folder")->required();
  command->add_option("NAME", options->wish.name, "of the files, and in the certificate")
      ->required();
  command->add_option("--host", options->wish.hosts,
                      "of a coordinator: a name or address under which it is reached; several");
  command->add_option("--role", options->roles,
                      "of a user or worker: submit, work or read; several");
  command->add_option("-o,--out", options->out, "the folder of the two files to write")
      ->type_name("FOLDER")
      ->capture_default_str();
  add_days(*command, options->days);
  command->callback([=, &exit_code] {
    for (const std::string& name : options->roles) {
      const auto role = role_by_name(name);
      if (!role.ok()) {
        exit_code = report(role.status());
        return;
      }
      options->wish.roles.insert(*role);
    }
    exit_code = report(issue_certificate(options->folder, options->wish, options->out, now_unix_s(),
                                         options->days * kDay_s));
  });
}

absl::Status revoke(const std::string& folder, const std::string& which) {
  ASSIGN_OR_RETURN(const auto revoked, revoke_certificates(folder, which, now_unix_s()));
  print_text("{} certificate{} revoked; {}/crl.pem is what coordinators read (--tls-crl)\n",
             revoked, revoked == 1 ? "" : "s", folder);
  return absl::OkStatus();
}

void add_ca_revoke(CLI::App& ca, int& exit_code) {
  auto* command = ca.add_subcommand("revoke", "take certificates back");
  auto folder = std::make_shared<std::string>(), which = std::make_shared<std::string>();
  command->add_option("FOLDER", *folder, "the authority's folder")->required();
  command->add_option("NAME", *which, "all of this name, or the one of this serial number")
      ->required();
  command->callback([=, &exit_code] { exit_code = report(revoke(*folder, *which)); });
}

absl::Status list_certificates(const std::string& folder, const OutputOptions& output) {
  ASSIGN_OR_RETURN(const auto issued, issued_certificates(folder));
  const double now = now_unix_s();
  return output.write([&](std::string_view format, std::ostream& out) {
    auto table = make_table_writer(
        format, {{"name"}, {"roles"}, {"valid_until_utc"}, {"state"}, {"serial"}}, out);
    if (!table.ok()) return table.status();
    for (const IssuedCertificate& one : issued) {
      std::string roles = role_list(one.facts.roles, "and");
      if (one.facts.of_a_server) roles += roles.empty() ? "coordinator" : ", coordinator";
      const std::string end = running_out(one.facts, now);
      (*table)->row({one.facts.name, roles,
                     absl::FormatTime("%Y-%m-%dT%H:%M:%SZ",
                                      absl::FromUnixSeconds(
                                          static_cast<std::int64_t>(one.facts.valid_until_unix_s)),
                                      absl::UTCTimeZone()),
                     one.revoked   ? "revoked"
                     : end.empty() ? "valid"
                                   : end,
                     one.facts.serial_hex});
    }
    return (*table)->finish();
  });
}

void add_ca_list(CLI::App& ca, int& exit_code) {
  auto* command = ca.add_subcommand("list", "what the authority has signed, and until when");
  auto folder = std::make_shared<std::string>();
  command->add_option("FOLDER", *folder, "the authority's folder")->required();
  auto output =
      std::make_shared<OutputOptions>(*command, std::vector<std::string>{"text", "csv", "json"});
  command->callback([=, &exit_code] { exit_code = report(list_certificates(*folder, *output)); });
}

}  // namespace

void add_ca(CLI::App& app, int& exit_code) {
  auto* ca = app.add_subcommand("ca", "certificates of a farm: who may submit, work and read");
  ca->require_subcommand(1);
  add_ca_init(*ca, exit_code);
  add_ca_issue(*ca, exit_code);
  add_ca_revoke(*ca, exit_code);
  add_ca_list(*ca, exit_code);
}

}  // namespace irsig
