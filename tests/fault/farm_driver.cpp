// Stands for `irsig run` in a test that kills it: a coordinator and two workers that never end.
#include <unistd.h>

#include <cstdio>

#include "coordinator/client/farm_client.h"
#include "coordinator/client/local_farm.h"
#include "tests/fault/synthetic_farm.h"

int main(int, char** argv) {
  auto farm = irsig::LocalFarm::start({.db_path = argv[1],
                                       .workers = 2,
                                       .coordinator_executable = IRSIG_COORDINATOR,
                                       .worker_executable = IRSIG_SYNTHETIC_WORKER,
                                       .worker_arguments = {"--seconds", "1000"}});
  if (!farm.ok()) return std::puts(std::string(farm.status().message()).c_str()), 1;
  if (!irsig::submit((*farm)->address(), irsig::frigate_sweep(4), {}, 1).ok()) return 1;
  if (!(*farm)->start_workers().ok()) return 1;
  pause();
}
