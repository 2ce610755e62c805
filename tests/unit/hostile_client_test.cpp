// Whatever a client sends, the coordinator refuses it with a reason and goes on: over a real
// socket, with no more than the messages of the service.
#include <gmock/gmock.h>
#include <grpcpp/client_context.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <future>

#include "absl/strings/str_cat.h"
#include "coordinator/client/channel.h"
#include "coordinator/client/farm_client.h"
#include "coordinator/client/fetch_asset.h"
#include "coordinator/farm_server.h"
#include "jobs/check_resolved.h"
#include "jobs/keys/expand.h"
#include "schema/farm.grpc.pb.h"
#include "schema/store/reader.h"
#include "tests/fault/synthetic_farm.h"
#include "tests/fault/synthetic_pictures.h"

namespace irsig {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// The memory of this process, and so of the coordinator in it.
double memory_mb() {
  std::ifstream in("/proc/self/statm");
  double pages = 0, resident = 0;
  in >> pages >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

class HostileClient : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = testing::TempDir() + "/irsig-hostile-XXXXXX";
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    address_ = *parse_address("unix:" + folder_ + "/farm");
    auto server = FarmServer::start({folder_ + "/test.sigdb",
                                     address_,
                                     {1, 60, 5, 0},  // no audits: they come by chance
                                     now_s,
                                     now_s,
                                     [](const absl::Status& status) { ADD_FAILURE() << status; },
                                     check_resolved});
    ASSERT_TRUE(server.ok()) << server.status();
    server_ = *std::move(server);
    farm_ = schema::Farm::NewStub(connect(address_));
  }
  void TearDown() override {
    farm_.reset();
    EXPECT_TRUE(server_->stop().ok());
    server_.reset();
    std::filesystem::remove_all(folder_);
  }

  // Bytes that claim to be a sweep.
  absl::Status submit_bytes(const std::string& bytes) {
    grpc::ClientContext context;
    schema::SubmitReply reply;
    const auto stream = farm_->Submit(&context, &reply);
    schema::SubmitChunk chunk;
    chunk.mutable_sweep()->set_size_bytes(bytes.size());
    chunk.mutable_sweep()->set_physics_version(1);
    bool open = stream->Write(chunk);
    for (std::size_t at = 0; open && at < bytes.size(); at += kPieceBytes) {
      chunk.set_piece(bytes.substr(at, kPieceBytes));
      open = stream->Write(chunk);
    }
    stream->WritesDone();
    return to_absl(stream->Finish());
  }

  absl::Status register_as(const std::string& name, schema::RegisterReply& reply) {
    schema::RegisterRequest request;
    request.set_worker_name(name);
    request.set_determinism_class(kSyntheticClass);
    request.set_physics_version(1);
    grpc::ClientContext context;
    return to_absl(farm_->Register(&context, request, &reply));
  }
  schema::LeaseReply lease(const std::string& worker_id) {
    schema::LeaseRequest request;
    request.set_worker_id(worker_id);
    schema::LeaseReply reply;
    grpc::ClientContext context;
    EXPECT_TRUE(farm_->Lease(&context, request, &reply).ok());
    return reply;
  }
  absl::Status complete(const std::string& worker_id, std::uint64_t token, const std::string& bytes,
                        const std::string& sweep_sha256 = {}) {
    grpc::ClientContext context;
    schema::CompleteReply reply;
    const auto stream = farm_->Complete(&context, &reply);
    bool open = true;
    for (std::size_t at = 0; open && at < bytes.size(); at += kPieceBytes) {
      schema::CompleteChunk chunk;
      chunk.set_worker_id(worker_id);
      chunk.set_fencing_token(token);
      chunk.set_result_bytes(bytes.size());
      chunk.set_sweep_sha256(sweep_sha256);
      chunk.set_piece(bytes.substr(at, kPieceBytes));
      open = stream->Write(chunk);
    }
    stream->WritesDone();
    const absl::Status status = to_absl(stream->Finish());
    taken_ = reply.state();
    return status;
  }
  schema::SweepStatus status() {
    const auto reply = farm_status(address_, 20);
    EXPECT_TRUE(reply.ok()) << reply.status();
    return reply.ok() && reply->sweep_size() == 1 ? reply->sweep(0) : schema::SweepStatus();
  }

  std::string folder_;
  Address address_;
  std::unique_ptr<FarmServer> server_;
  std::unique_ptr<schema::Farm::Stub> farm_;
  schema::CompleteReply::State taken_ = schema::CompleteReply::STATE_UNSPECIFIED;
};

// One of each kind; every field: unit.jobs, CheckResolved.
TEST_F(HostileClient, SubmissionsThatNoFileCouldBeAreRefused) {
  const schema::ResolvedSweep good = frigate_sweep(2);
  struct Damage {
    std::string named;
    std::function<void(schema::ResolvedSweep&)> apply;
  };
  const std::vector<Damage> damages = {
      {"condition[0].part_temperature_k[0] = -5",
       [](auto& s) { s.mutable_condition(0)->set_part_temperature_k(0, -5); }},
      {"condition[0].part_temperature_k[0] = nan",
       [](auto& s) { s.mutable_condition(0)->set_part_temperature_k(0, NAN); }},
      {"published[0].relation = \"cousin\"",
       [](auto& s) { s.mutable_sweep()->add_published()->set_relation("cousin"); }},
      {"condition has 2 elements, expected one for each season at each time: 3",
       [](auto& s) { s.mutable_condition()->RemoveLast(); }},
      {"sweep.time has 10001 elements",
       [](auto& s) {
         while (s.sweep().time_size() < 10001) s.mutable_sweep()->add_time("10:30Z");
       }},
      {"sweep.accuracy.relative_error = -1",
       [](auto& s) { s.mutable_sweep()->mutable_accuracy()->set_relative_error(-1); }},
      {"sweep.band[0].step_um = 0",
       [](auto& s) { s.mutable_sweep()->mutable_band(0)->set_step_um(0); }},
  };
  for (const Damage& damage : damages) {
    schema::ResolvedSweep sweep = good;
    damage.apply(sweep);
    const absl::Status refused = submit(address_, sweep, {}, 1).status();
    EXPECT_TRUE(absl::IsInvalidArgument(refused)) << damage.named << ": " << refused;
    EXPECT_THAT(std::string(refused.message()), HasSubstr(damage.named));
  }
  EXPECT_TRUE(submit(address_, good, {}, 1).ok()) << "it goes on";
}

TEST_F(HostileClient, MemoryIsNotTakenForWhatIsRefused) {
  const double before_mb = memory_mb();
  std::string materials;  // 30 million, of 600 bytes each
  for (int i = 0; i < 10000000; ++i) materials += std::string("\x32\0", 2);
  std::string sweep = "\x0a";
  for (std::uint64_t n = materials.size();; n >>= 7) {
    sweep += static_cast<char>((n & 0x7fU) | (n > 0x7f ? 0x80U : 0U));
    if (n <= 0x7f) break;
  }
  sweep += materials;
  const absl::Status refused = submit_bytes(sweep);
  EXPECT_TRUE(absl::IsInvalidArgument(refused)) << refused;
  EXPECT_THAT(std::string(refused.message()), HasSubstr("memory"));
  EXPECT_TRUE(absl::IsInvalidArgument(submit_bytes("no sweep at all")));
  schema::RegisterReply reply;
  EXPECT_FALSE(register_as(std::string(60000000, 'x'), reply).ok());
  EXPECT_TRUE(absl::IsInvalidArgument(register_as(std::string(1001, 'x'), reply)));
  EXPECT_TRUE(absl::IsInvalidArgument(register_as("\x1b[2J", reply)));
  // Nobody's bytes are kept who is not registered.
  const absl::Status nobody = complete("nobody", 7, std::string(30000000, '\0'));
  EXPECT_TRUE(absl::IsNotFound(nobody)) << nobody;
  EXPECT_LT(memory_mb() - before_mb, 400);
  EXPECT_TRUE(farm_status(address_, 20).ok());
}

// 30 kB that inflate to 30 MB, four times at once: nothing is inflated, since nobody of ours
// compresses. An oversized message without compression: above.
TEST_F(HostileClient, WhatIsCompressedIsRefusedAsItIs) {
  std::vector<std::future<absl::Status>> answers;
  const std::string much(30000000, 'x');
  for (const auto how : {GRPC_COMPRESS_GZIP, GRPC_COMPRESS_DEFLATE})
    for (int i = 0; i < 2; ++i)
      answers.push_back(std::async(std::launch::async, [&, how] {
        schema::RegisterRequest request;
        request.set_worker_name(much);
        grpc::ClientContext context;
        context.set_compression_algorithm(how);
        schema::RegisterReply reply;
        return to_absl(farm_->Register(&context, request, &reply));
      }));
  for (auto& answer : answers) {
    const absl::Status refused = answer.get();
    EXPECT_TRUE(absl::IsUnimplemented(refused)) << refused;
  }
  // A small one is refused, too: it is the encoding that is.
  schema::RegisterRequest request;
  request.set_worker_name(std::string(900, 'x'));
  grpc::ClientContext context;
  context.set_compression_algorithm(GRPC_COMPRESS_GZIP);
  schema::RegisterReply reply;
  EXPECT_TRUE(absl::IsUnimplemented(to_absl(farm_->Register(&context, request, &reply))));
  EXPECT_TRUE(farm_status(address_, 20).ok());
}

// Rows that are empty: two bytes each, 1 kB in memory.
TEST_F(HostileClient, ABombOfAHolderOfALeaseCountsAsAFailureOfTheJob) {
  ASSERT_TRUE(submit(address_, frigate_sweep(1), {}, 1).ok());
  schema::RegisterReply worker;
  ASSERT_TRUE(register_as("a", worker).ok());
  const schema::LeaseReply job = lease(worker.worker_id());
  std::string rows;
  for (int i = 0; i < 4000000; ++i) rows += std::string("\x0a\0", 2);
  std::string bytes = "\x12";
  for (std::uint64_t n = rows.size();; n >>= 7) {
    bytes += static_cast<char>((n & 0x7fU) | (n > 0x7f ? 0x80U : 0U));
    if (n <= 0x7f) break;
  }
  const absl::Status refused = complete(worker.worker_id(), job.fencing_token(), bytes + rows);
  EXPECT_TRUE(absl::IsInvalidArgument(refused)) << refused;
  EXPECT_EQ(status().leased(), 0U);
  EXPECT_EQ(status().done(), 0U);
}

TEST_F(HostileClient, ResultsThatCannotBeAreRefusedAndTheJobIsGivenAgain) {
  struct Damage {
    std::string named;
    std::function<void(schema::JobResult&)> apply;
  };
  const auto row = [](schema::JobResult& r) { return r.mutable_view()->mutable_row(0); };
  std::mt19937_64 random(1);
  const std::string black = png_of(4096, 4096, std::string(std::size_t{4097} * 4096, '\0'));
  const std::string too_long = png_of(128, 40, std::string(200000000, '\0'));
  const std::vector<Damage> damages = {
      {"intensity_w_sr.value = 1e+300",
       [&](auto& r) { row(r)->mutable_intensity_w_sr()->set_value(1e300); }},
      {"source_radiance_temperature_k = 1e+300",
       [&](auto& r) { row(r)->set_source_radiance_temperature_k(1e300); }},
      {"path_transmittance = 17", [&](auto& r) { row(r)->set_path_transmittance(17); }},
      {"path_transmittance = -1", [&](auto& r) { row(r)->set_path_transmittance(-1); }},
      {"path_transmittance[3] = 17",
       [&](auto& r) { row(r)->mutable_spectrum()->set_path_transmittance(3, 17); }},
      {"its causes sum to",
       [&](auto& r) {
         row(r)->mutable_sun_reflected_w_sr()->set_value(row(r)->sun_reflected_w_sr().value() *
                                                         (1 + 1e-6));
       }},
      {"its parts sum to",
       [&](auto& r) {
         row(r)->mutable_part(0)->mutable_intensity_w_sr()->set_value(
             row(r)->part(0).intensity_w_sr().value() * (1 + 1e-6));
       }},
      {"spectral_intensity_w_sr_um[2] = ",
       [&](auto& r) {
         row(r)->mutable_spectrum()->set_spectral_intensity_w_sr_um(
             2, 1.001F * row(r)->spectrum().spectral_intensity_w_sr_um(2));
       }},
      {"its shares sum to",
       [&](auto& r) { row(r)->mutable_energy()->mutable_balance()->set_value(1e-3); }},
      {"emitted_w_sr.stderr = -1",
       [&](auto& r) { row(r)->mutable_emitted_w_sr()->set_stderr(-1); }},
      {"intensity_w_sr.value = nan",
       [&](auto& r) { row(r)->mutable_intensity_w_sr()->set_value(NAN); }},
      {"png is no PNG file", [&](auto& r) { row(r)->mutable_thumbnail()->set_png("text"); }},
      {"png is 4096 x 4096 pixels", [&](auto& r) { row(r)->mutable_thumbnail()->set_png(black); }},
      {"png has damaged pixels, or too many",
       [&](auto& r) { row(r)->mutable_thumbnail()->set_png(too_long); }},
      {"png is damaged: a checksum does not match",
       [&](auto& r) { (*row(r)->mutable_thumbnail()->mutable_png())[60] ^= 1; }},
      {"png is cut off",
       [&](auto& r) {
         std::string& png = *row(r)->mutable_thumbnail()->mutable_png();
         png.resize(png.size() - 3);
       }},
      {"exr is no OpenEXR file", [&](auto& r) { row(r)->mutable_thumbnail()->set_exr("text"); }},
      {"exr is of another size",
       [&](auto& r) { row(r)->mutable_thumbnail()->set_exr(synthetic_exr(300, 30, 100, random)); }},
      {"exr has 1000",
       [&](auto& r) {
         row(r)->mutable_thumbnail()->set_exr(synthetic_exr(128, 40, 1000000, random));
       }},
      {"thumbnail is 5000 x 40 pixels",
       [&](auto& r) { row(r)->mutable_thumbnail()->set_width_px(5000); }},
      {"a thumbnail is 200 x 40 pixels, its sweep asks for 128",
       [&](auto& r) {
         auto& picture = *row(r)->mutable_thumbnail();
         picture.set_width_px(200);
         picture.set_png(synthetic_png(200, 40, random));
         picture.set_exr(synthetic_exr(200, 40, 100, random));
         picture.set_stderr_exr(synthetic_exr(200, 40, 100, random));
       }},
      {"physics version 2", [](auto& r) { r.set_physics_version(2); }},
      {"determinism class", [](auto& r) { r.set_determinism_class("another"); }},
      {"build_id has control characters", [](auto& r) { r.set_build_id("\x1b[2J"); }},
      {"spectrum.spectral_intensity_modes has 7 bytes, expected a multiple of",
       [&](auto& r) { row(r)->mutable_spectrum()->set_spectral_intensity_modes("modes\x01\x02"); }},
      {"modes, expected at most",
       [&](auto& r) {
         auto& spectrum = *row(r)->mutable_spectrum();
         const auto bytes = static_cast<std::size_t>(2 * spectrum.lambda_um_size());
         spectrum.set_contrast_spectral_intensity_modes(std::string(5000 * bytes, '\0'));
       }},
      {"silhouette is 5000 x 40 pixels",
       [&](auto& r) { r.mutable_view()->mutable_silhouette()->set_width_px(5000); }},
      {"states 65536 samples of a pixel, expected 1 to 65535",
       [&](auto& r) { r.mutable_view()->mutable_silhouette()->set_pixel_samples(65536); }},
      {"has a pixel of more than 1 samples",
       [&](auto& r) { r.mutable_view()->mutable_silhouette()->set_pixel_samples(1); }},
      {"has a part outside the picture",
       [&](auto& r) {
         r.mutable_view()->mutable_silhouette()->mutable_part(0)->set_left_px(0xffffffffU);
       }},
      {"has a part with damaged samples",
       [&](auto& r) {
         r.mutable_view()->mutable_silhouette()->mutable_part(0)->set_width_px(126);
       }},
      {"has a part with damaged samples",
       [&](auto& r) {
         r.mutable_view()->mutable_silhouette()->mutable_part(0)->set_samples("no zlib");
       }},
      {"silhouette names part 0 twice",
       [&](auto& r) {
         r.mutable_view()->mutable_silhouette()->mutable_part(1)->set_part_index(0);
       }},
      {"has a part that no sample sees",
       [&](auto& r) {
         r.mutable_view()->mutable_silhouette()->mutable_part(0)->set_samples(
             packed_counts(std::vector<std::uint16_t>(127, 0)));
       }},
      {"has a set of parts with damaged samples",
       [&](auto& r) {
         r.mutable_view()->mutable_silhouette()->mutable_part_set(0)->set_samples("no zlib");
       }},
      {"has a set of parts with damaged samples",  // beyond the last pixel
       [&](auto& r) {
         schema::Silhouette& s = *r.mutable_view()->mutable_silhouette();
         s.clear_part_set();
         add_part_set({0}, {128 * 40 - 1, 0}, {1, 1}, s);
       }},
      {"has a set of parts with damaged samples",  // no rays
       [&](auto& r) {
         schema::Silhouette& s = *r.mutable_view()->mutable_silhouette();
         s.clear_part_set();
         add_part_set({0}, {3}, {0}, s);
       }},
      {"has a pixel of more than 8 samples",
       [&](auto& r) { add_part_set({1}, {0}, {1}, *r.mutable_view()->mutable_silhouette()); }},
      {"has a set of parts with no area outside the frame",
       [&](auto& r) {
         r.mutable_view()->mutable_silhouette()->mutable_part_set(0)->set_outside_px(-1);
       }},
      {"silhouette has more parts than the rows",
       [&](auto& r) {
         schema::Silhouette& s = *r.mutable_view()->mutable_silhouette();
         for (std::uint32_t i = 1000; i < 1100; ++i) {
           *s.add_part() = s.part(0);
           s.mutable_part(s.part_size() - 1)->set_part_index(i);
         }
       }},
      {"times the variance of bin 0",
       [&](auto& r) {
         auto& spectrum = *row(r)->mutable_spectrum();
         const auto bytes = static_cast<std::size_t>(2 * spectrum.lambda_um_size());
         spectrum.set_apparent_spectral_intensity_modes(std::string(2 * bytes, '\x7f'));
       }},
      {"wavelengths, its sweep asks for",
       [&](auto& r) {
         auto& spectrum = *row(r)->mutable_spectrum();
         const auto* type = spectrum.GetDescriptor();
         for (int f = 0; f < type->field_count(); ++f)
           if (type->field(f)->is_repeated() &&
               spectrum.GetReflection()->FieldSize(spectrum, type->field(f)) > 0)
             spectrum.GetReflection()->RemoveLast(&spectrum, type->field(f));
       }},
  };
  const schema::ResolvedSweep sweep = frigate_sweep(static_cast<std::uint32_t>(damages.size()));
  ASSERT_TRUE(submit(address_, sweep, {}, 1).ok());
  schema::RegisterReply worker;
  ASSERT_TRUE(register_as("a", worker).ok());
  for (const Damage& damage : damages) {
    const schema::LeaseReply job = lease(worker.worker_id());
    ASSERT_EQ(job.state(), schema::LeaseReply::STATE_LEASED);
    schema::JobResult result = synthetic_result(sweep, job.job());
    damage.apply(result);
    const absl::Status refused =
        complete(worker.worker_id(), job.fencing_token(), result.SerializeAsString());
    EXPECT_TRUE(absl::IsInvalidArgument(refused)) << damage.named << ": " << refused;
    EXPECT_THAT(std::string(refused.message()), HasSubstr(damage.named));
  }
  EXPECT_EQ(status().done(), 0U);
  for (std::size_t i = 0; i < damages.size(); ++i) {
    const schema::LeaseReply job = lease(worker.worker_id());
    const absl::Status taken = complete(worker.worker_id(), job.fencing_token(),
                                        synthetic_result(sweep, job.job()).SerializeAsString());
    ASSERT_TRUE(taken.ok()) << taken;
  }
  EXPECT_EQ(status().done(), damages.size());
}

// A status travels in a header, of which clients take 8 kB: a longer one would be lost with its
// code.
TEST_F(HostileClient, WhatIsRefusedAtLengthIsRefusedWithItsReason) {
  for (const char* letter : {"x", "\xc3\xa9", "\x01"}) {
    std::string name;
    while (name.size() < 1'000'000) name += letter;
    grpc::ClientContext of_lease, of_cancel, of_fetch;
    schema::LeaseRequest lease;
    lease.set_worker_id(name);
    schema::LeaseReply leased;
    const auto unknown = to_absl(farm_->Lease(&of_lease, lease, &leased));
    EXPECT_TRUE(absl::IsNotFound(unknown)) << unknown;
    EXPECT_THAT(std::string(unknown.message()), HasSubstr("unknown worker"));
    schema::CancelRequest cancel;
    cancel.set_sweep_sha256(name);
    schema::CancelReply cancelled;
    const auto no_sweep = to_absl(farm_->Cancel(&of_cancel, cancel, &cancelled));
    EXPECT_TRUE(absl::IsNotFound(no_sweep)) << no_sweep;
    EXPECT_THAT(std::string(no_sweep.message()), HasSubstr("no sweep"));
    EXPECT_TRUE(absl::IsNotFound(fetch_file(*farm_, name, 20).status()));
  }
}

TEST_F(HostileClient, OfManyFailuresTheRestIsCounted) {
  constexpr std::uint32_t kJobs = 30;
  ASSERT_TRUE(submit(address_, frigate_sweep(kJobs), {}, 1).ok());
  schema::RegisterReply worker;
  ASSERT_TRUE(register_as("a", worker).ok());
  for (std::uint32_t i = 0; i < 3 * kJobs; ++i) {
    schema::FailRequest request;
    request.set_worker_id(worker.worker_id());
    request.set_fencing_token(lease(worker.worker_id()).fencing_token());
    request.set_message(std::string(100000, 'x'));
    schema::FailReply reply;
    grpc::ClientContext context;
    ASSERT_TRUE(farm_->Fail(&context, request, &reply).ok());
    (void)status();  // kept beside the queue: as it changes
  }
  const schema::SweepStatus ended = status();
  EXPECT_EQ(ended.quarantined(), kJobs);
  ASSERT_EQ(ended.failure_size(), 21);
  EXPECT_EQ(ended.failure(20), "and 10 more");
  EXPECT_LT(ended.ByteSizeLong(), 20000U);
}

// A result is taken by what it is; what was stored stays as it was, whoever says otherwise.
TEST_F(HostileClient, WhatIsStoredStays) {
  using Taken = schema::CompleteReply;
  const schema::ResolvedSweep sweep = frigate_sweep(9);
  const auto submitted = submit(address_, sweep, {}, 1);
  ASSERT_TRUE(submitted.ok()) << submitted.status();
  const std::string& sha = submitted->sweep_sha256();
  schema::RegisterReply a, b;
  ASSERT_TRUE(register_as("a", a).ok());
  ASSERT_TRUE(register_as("b", b).ok());
  const schema::LeaseReply first = lease(a.worker_id()), second = lease(b.worker_id());
  const std::string one = synthetic_result(sweep, first.job()).SerializeAsString();
  const std::string two = synthetic_result(sweep, second.job()).SerializeAsString();
  ASSERT_TRUE(complete(a.worker_id(), first.fencing_token(), one, sha).ok());
  const auto digest = [&] {
    auto reader = StoreReader::open(folder_ + "/test.sigdb");
    EXPECT_TRUE(reader.ok()) << reader.status();
    return reader.ok() ? (*reader)->digest().value_or("none") : "";
  };
  const std::string before = digest();
  struct Sent {
    std::string worker_id;
    std::uint64_t token;
    const std::string& bytes;
    std::string sweep, what;
    absl::StatusCode code;
    Taken::State taken;
  };
  const auto kNone = Taken::STATE_UNSPECIFIED;
  const std::vector<Sent> sent = {
      {a.worker_id(), first.fencing_token(), one, sha, "replayed", absl::StatusCode::kOk,
       Taken::STATE_KNOWN},
      {b.worker_id(), first.fencing_token(), one, sha, "replayed by another", absl::StatusCode::kOk,
       Taken::STATE_KNOWN},
      {a.worker_id(), 0, one, sha, "without a lease", absl::StatusCode::kOk, Taken::STATE_KNOWN},
      {a.worker_id(), 0, one, std::string(64, '0'), "of no sweep", absl::StatusCode::kOk,
       Taken::STATE_UNKNOWN_SWEEP},
      {a.worker_id(), 0, one, "", "of no sweep at all", absl::StatusCode::kOk,
       Taken::STATE_UNKNOWN_SWEEP},
      {a.worker_id(), 0, one, std::string(65, '0'), "of no hash",
       absl::StatusCode::kInvalidArgument, kNone},
      {"nobody", second.fencing_token(), two, sha, "not registered", absl::StatusCode::kNotFound,
       kNone},
      {b.worker_id(), second.fencing_token(), one, sha, "another job's under its own lease",
       absl::StatusCode::kInvalidArgument, kNone},
  };
  for (const Sent& one_of : sent) {
    const absl::Status status =
        complete(one_of.worker_id, one_of.token, one_of.bytes, one_of.sweep);
    EXPECT_EQ(status.code(), one_of.code) << one_of.what << ": " << status;
    EXPECT_EQ(taken_, one_of.taken) << one_of.what;
    EXPECT_EQ(digest(), before) << one_of.what;
  }
  // Another content under the key of a done job is kept aside; a third worker decides whose it is.
  schema::JobResult other = synthetic_result(sweep, first.job());
  other.mutable_view()->mutable_row(0)->set_sun_azimuth_deg(1);
  EXPECT_TRUE(complete(b.worker_id(), 0, other.SerializeAsString(), sha).ok());
  EXPECT_EQ(taken_, Taken::STATE_ASIDE);
  EXPECT_EQ(digest(), before);
  const auto names_set_aside = [&] {
    std::vector<std::string> names;
    const auto told = farm_status(address_);
    EXPECT_TRUE(told.ok()) << told.status();
    if (!told.ok()) return names;
    EXPECT_EQ(told->differing(), 1U);
    for (const schema::WorkerStatus& worker : told->worker())
      if (worker.state() == schema::WorkerStatus::STATE_SET_ASIDE) names.push_back(worker.name());
    return names;
  };
  EXPECT_THAT(names_set_aside(), IsEmpty());
  schema::RegisterReply c;
  ASSERT_TRUE(register_as("c", c).ok());
  const schema::LeaseReply again = lease(c.worker_id());
  ASSERT_EQ(again.job().job_key(), first.job().job_key());
  ASSERT_TRUE(complete(c.worker_id(), again.fencing_token(), one, sha).ok());
  EXPECT_THAT(names_set_aside(), ElementsAre("b"));
  EXPECT_TRUE(absl::IsAborted(complete(b.worker_id(), 0, two, sha)));
  EXPECT_EQ(digest(), before);
  EXPECT_EQ(status().done(), 1U);
  // Words that the service does not know.
  for (const auto& damage : std::vector<std::function<void(schema::SignatureRow&)>>{
           [](auto& row) { row.set_stop_reason(static_cast<schema::StopReason>(99)); },
           [](auto& row) { row.set_stop_reason(static_cast<schema::StopReason>(-1)); },
           [](auto& row) {
             row.mutable_effect(0)->set_state(static_cast<schema::EffectState>(77));
           },
           [](auto& row) { row.set_condition_index(4000000000U); }}) {
    const schema::LeaseReply job = lease(c.worker_id());
    ASSERT_EQ(job.state(), schema::LeaseReply::STATE_LEASED);
    schema::JobResult result = synthetic_result(sweep, job.job());
    damage(*result.mutable_view()->mutable_row(0));
    const absl::Status refused =
        complete(c.worker_id(), job.fencing_token(), result.SerializeAsString());
    EXPECT_TRUE(absl::IsInvalidArgument(refused)) << refused;
    EXPECT_EQ(digest(), before);
  }
}

// A transfer that breaks off leaves nothing: the lease takes the whole result, the sweep is stored.
TEST_F(HostileClient, WhatIsCutOffLeavesNothing) {
  const schema::ResolvedSweep sweep = frigate_sweep(2);
  const std::string bytes = sweep.SerializeAsString();
  EXPECT_FALSE(submit_bytes(bytes.substr(0, bytes.size() - 7)).ok());
  EXPECT_FALSE(submit_bytes("").ok());
  for (const bool cancelled : {false, true}) {
    grpc::ClientContext context;
    schema::SubmitReply reply;
    const auto stream = farm_->Submit(&context, &reply);
    schema::SubmitChunk chunk;
    chunk.mutable_sweep()->set_size_bytes(bytes.size());
    chunk.mutable_sweep()->set_physics_version(1);
    stream->Write(chunk);
    chunk.set_piece(bytes.substr(0, bytes.size() / 2));
    stream->Write(chunk);
    if (cancelled) context.TryCancel();
    stream->WritesDone();
    EXPECT_FALSE(stream->Finish().ok());
  }
  EXPECT_EQ(farm_status(address_, 20)->sweep_size(), 0);
  ASSERT_TRUE(submit(address_, sweep, {}, 1).ok());
  schema::RegisterReply worker;
  ASSERT_TRUE(register_as("a", worker).ok());
  const schema::LeaseReply job = lease(worker.worker_id());
  const std::string result = synthetic_result(sweep, job.job()).SerializeAsString();
  for (const std::uint64_t announced :
       {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{result.size() + 1}, ~std::uint64_t{0}}) {
    grpc::ClientContext context;
    schema::CompleteReply reply;
    const auto stream = farm_->Complete(&context, &reply);
    schema::CompleteChunk chunk;
    chunk.set_worker_id(worker.worker_id());
    chunk.set_fencing_token(job.fencing_token());
    chunk.set_result_bytes(announced);
    chunk.set_piece(result);
    stream->Write(chunk);
    stream->WritesDone();
    EXPECT_FALSE(stream->Finish().ok()) << announced;
  }
  EXPECT_EQ(status().leased(), 1U);
  EXPECT_TRUE(complete(worker.worker_id(), job.fencing_token(), result).ok());
}

// Only so many submissions run at a time; the next ones are told to wait, and nobody is held up.
TEST_F(HostileClient, AFloodOfSubmissionsIsTurnedAway) {
  constexpr int kFlood = 40, kTogether = 4;
  struct Open {
    grpc::ClientContext context;
    schema::SubmitReply reply;
    std::unique_ptr<grpc::ClientWriter<schema::SubmitChunk>> stream;
  };
  const std::string bytes = frigate_sweep(1).SerializeAsString();
  std::vector<std::unique_ptr<Open>> open;
  for (int i = 0; i < kFlood; ++i) {
    open.push_back(std::make_unique<Open>());
    open.back()->stream = farm_->Submit(&open.back()->context, &open.back()->reply);
    schema::SubmitChunk chunk;
    chunk.mutable_sweep()->set_size_bytes(bytes.size());
    chunk.mutable_sweep()->set_physics_version(1);
    open.back()->stream->Write(chunk);
  }
  // Empty pieces change nothing: they tell who has been turned away.
  const auto is_open = [](const auto& call) {
    schema::SubmitChunk nothing;
    nothing.set_piece("");
    return call->stream->Write(nothing);
  };
  const double until_s = now_s() + 120;
  while (std::count_if(open.begin(), open.end(), is_open) > kTogether && now_s() < until_s) {
  }
  EXPECT_TRUE(farm_status(address_, 20).ok());
  int refused = 0, taken = 0;
  for (const auto& call : open) {
    schema::SubmitChunk chunk;
    chunk.set_piece(bytes);
    call->stream->Write(chunk);
    call->stream->WritesDone();
    const absl::Status status = to_absl(call->stream->Finish());
    ++(status.ok() ? taken : refused);
    EXPECT_TRUE(status.ok() || absl::IsResourceExhausted(status)) << status;
  }
  EXPECT_EQ(taken, kTogether);
  EXPECT_EQ(refused, kFlood - kTogether);
  EXPECT_TRUE(submit(address_, frigate_sweep(3), {}, 1).ok()) << "it goes on";
}

// A model arrives in pieces, is held against its hash and is not kept in memory.
TEST_F(HostileClient, AssetsGoToTheDiskAndAreHeldAgainstTheirHashes) {
  schema::ResolvedSweep sweep = frigate_sweep(1);
  const std::string model(40000000, 'm');
  sweep.set_model_sha256(sha256_hex(model));
  const double before_mb = memory_mb();
  EXPECT_TRUE(absl::IsInvalidArgument(
      submit(address_, sweep, {{sweep.model_sha256(), "another model"}}, 1).status()));
  ASSERT_TRUE(submit(address_, sweep, {{sweep.model_sha256(), model}}, 1).ok());
  EXPECT_LT(memory_mb() - before_mb, 100 + 2 * 40) << "the client's own copies";
  const auto back = fetch_file(*farm_, sweep.model_sha256(), 60);
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(*back, model);
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_))
    files += entry.path().filename().string().find("spool") != std::string::npos;
  EXPECT_EQ(files, 0U);
}

}  // namespace
}  // namespace irsig
