#include <memory>
#include <string>

#include "cli/commands.h"
#include "schema/store/reader.h"
#include "view/base/print.h"

namespace irsig {

void add_digest(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("digest",
                                         "Print the SHA-256 of a database's content: equal for "
                                         "equal results, whoever computed them and when");
  const auto path = std::make_shared<std::string>();
  command->add_option("DB", *path, "the database")->required();
  command->callback([path, &exit_code] {
    const auto reader = StoreReader::open(*path);
    const auto digest = reader.ok() ? (*reader)->digest() : reader.status();
    exit_code = report(digest.status());
    if (digest.ok()) data_output() << *digest << "\n";
  });
}

}  // namespace irsig
