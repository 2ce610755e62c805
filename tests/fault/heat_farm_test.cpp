// A sweep with computed temperatures through real coordinators and workers: what is stored is what
// one process computes by itself.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <sstream>
#include <thread>

#include "coordinator/client/farm_client.h"
#include "coordinator/client/local_farm.h"
#include "core/geo/sun.h"
#include "jobs/keys/expand.h"
#include "jobs/resolve_sweep.h"
#include "jobs/text/sweep_file.h"
#include "planning/export_temperatures.h"
#include "runner/heat_outputs.h"
#include "runner/job_runner.h"
#include "schema/store/reader.h"
#include "tests/unit/sweep_text.h"

namespace irsig {
namespace {

// The frigate at one hour of a winter's day, with few facets and samples.
schema::ResolvedSweep heated_frigate() {
  const std::filesystem::path path = IRSIG_SOURCE_DIR "/jobs/examples/frigate_day.toml";
  auto file = parse_sweep(text_of(path), path.string());
  EXPECT_TRUE(file.ok()) << file.status();
  const auto read = [&](const std::string& name) -> absl::StatusOr<std::string> {
    return text_of(path.parent_path() / name);
  };
  EXPECT_TRUE(read_material_files(*file, read).ok());
  EXPECT_TRUE(read_weather_files(*file, read).ok());
  schema::Sweep& sweep = file->sweep;
  sweep.mutable_season()->DeleteSubrange(1, sweep.season_size() - 1);
  sweep.mutable_time()->DeleteSubrange(1, sweep.time_size() - 1);
  sweep.mutable_model()->set_triangles(2000);
  sweep.mutable_viewpoints()->set_count(3);
  sweep.mutable_heat()->set_rays(64);
  sweep.clear_uncertainty();
  sweep.mutable_accuracy()->clear_relative_error();
  sweep.mutable_accuracy()->set_samples_per_replicate(64);
  sweep.mutable_output()->set_thumbnail_px(0);
  const auto resolved = resolve_sweep(*file, "");
  EXPECT_TRUE(resolved.ok()) << resolved.status();
  return *resolved;
}

TEST(HeatFarm, StoresWhatOneProcessComputes) {
  std::string folder = "/tmp/irsig-heat-XXXXXX";
  ASSERT_NE(mkdtemp(folder.data()), nullptr);
  const schema::ResolvedSweep sweep = heated_frigate();
  const std::string db = folder + "/heat.sigdb";
  {
    auto farm = LocalFarm::start({.db_path = db,
                                  .workers = 2,
                                  .coordinator_executable = IRSIG_COORDINATOR,
                                  .worker_executable = IRSIG_WORKER,
                                  .worker_arguments = {}});
    ASSERT_TRUE(farm.ok()) << farm.status();
    const auto sent =
        submit((*farm)->address(), sweep, {}, static_cast<std::uint32_t>(physics_version()));
    ASSERT_TRUE(sent.ok()) << sent.status();
    ASSERT_TRUE((*farm)->start_workers().ok());
    schema::SweepStatus status;
    do {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      status = farm_status((*farm)->address())->sweep(0);
      ASSERT_EQ(status.quarantined(), 0U) << status.failure(0);
      ASSERT_TRUE((*farm)->keep_alive(status.done()).ok());
    } while (status.done() < status.jobs());
    EXPECT_EQ(status.heat_jobs(), static_cast<std::uint64_t>(sweep.heat_size()));
    ASSERT_TRUE((*farm)->stop().ok());
  }
  const auto reader = StoreReader::open(db).value();
  const HeatOutputs heat = heat_outputs(sweep, {}).value();
  EXPECT_EQ(reader->sweep(sweep.sweep().name()).value().heat, heat);
  EXPECT_FALSE(reader->computed_temperatures({}).value().empty());
  const auto runner = JobRunner::create(sweep, {}, heat, {}).value();
  const auto rows = reader->find({}).value();
  std::size_t row = 0;
  for (const schema::JobSpec& job : expand_jobs(sweep, physics_version())) {
    if (!job.has_view()) continue;
    const auto computed = runner->run(job);
    ASSERT_TRUE(computed.ok()) << computed.status();
    for (const schema::SignatureRow& expected : computed->view().row()) {
      EXPECT_EQ(rows[row].intensity_w_sr, expected.intensity_w_sr().value());
      EXPECT_EQ(rows[row++].temperature_bound_w_sr, expected.temperature_bound_w_sr());
    }
  }
  EXPECT_EQ(row, rows.size());
  std::ostringstream csv;
  const absl::Status exported = export_temperatures(db, "", "", "", csv);
  ASSERT_TRUE(exported.ok()) << exported;
  schema::HeatField field;
  ASSERT_TRUE(field.ParseFromString(heat[0]));
  const std::string lines = csv.str();
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 1 + field.facets());
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace irsig
