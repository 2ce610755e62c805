#include "coordinator/farm_service.h"

#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "coordinator/client/channel.h"
#include "core/base/status_macros.h"
#include "schema/store/check/check_plausible.h"
#include "schema/store/tables/content.h"
#include "schema/wire_size.h"

namespace irsig {
namespace {

// One call, one request of the farm: its answer is sent after the commit.
template <class Reply, class Ask>
grpc::ServerUnaryReactor* answer(CommitLoop& loop, CommitLoop::Kind kind,
                                 grpc::CallbackServerContext* context, Reply* reply, Ask ask) {
  auto* reactor = context->DefaultReactor();
  loop.post(
      kind,
      [reply, ask = std::move(ask)](Farm& farm) -> absl::Status {
        ASSIGN_OR_RETURN(*reply, ask(farm));
        return absl::OkStatus();
      },
      [reactor](const absl::Status& status) { reactor->Finish(to_grpc(status)); });
  return reactor;
}

// Whatever a request holds, its call ends.
template <class Work>
absl::Status safely(Work work) {
  try {
    return work();
  } catch (const std::exception& error) {
    return absl::InternalError(absl::StrCat("the request failed: ", error.what()));
  }
}

// A call that was refused at the door.
grpc::ServerUnaryReactor* refuse(grpc::CallbackServerContext* context, const absl::Status& why) {
  auto* reactor = context->DefaultReactor();
  reactor->Finish(to_grpc(why));
  return reactor;
}
template <class Stream>
class RefusedStream final : public Stream {
 public:
  explicit RefusedStream(const absl::Status& why) { this->Finish(to_grpc(why)); }
  void OnDone() override { delete this; }
};

// Reads a stream of chunks to its end, then finishes once. The derived class takes the chunks; it
// deletes itself when gRPC is done with it.
template <class Chunk>
class ChunkReader : public grpc::ServerReadReactor<Chunk>, private OpenCalls::Call {
 public:
  ChunkReader(grpc::CallbackServerContext* context, OpenCalls& calls)
      : context_(context), calls_(calls) {
    calls_.add(*this);
  }
  ~ChunkReader() override { calls_.remove(*this); }

  void OnReadDone(bool ok) override {
    if (ok) {
      calls_.moved(*this, chunk_.ByteSizeLong());
      if (auto status = safely([&] { return take(chunk_); }); !status.ok()) return end(status);
      chunk_.Clear();
      return this->StartRead(&chunk_);
    }
    calls_.remove(*this);  // from here on the sender waits for us
    if (context_->IsCancelled()) {
      return end(absl::CancelledError("the sender went away"));
    }
    if (auto status = safely([&] { return finish_reading(); }); !status.ok()) end(status);
  }
  void OnDone() override { delete this; }

 protected:
  // Releases the call's resources as soon as its answer is there, and not only when gRPC has
  // finished with the call.
  void end(const absl::Status& status) {
    let_go();
    this->Finish(to_grpc(status));
  }
  virtual void let_go() = 0;
  void start() { this->StartRead(&chunk_); }
  virtual absl::Status take(Chunk& chunk) = 0;
  virtual absl::Status finish_reading() = 0;  // OK: it leads to Finish; else nothing has begun

 private:
  void cancel() override { context_->TryCancel(); }

  grpc::CallbackServerContext* context_;
  OpenCalls& calls_;
  Chunk chunk_;
};

// UNAVAILABLE to workers, who try again by themselves; to others a refusal.
absl::Status busy(absl::StatusCode code, const char* what) {
  return {code, absl::StrCat("the coordinator has too many ", what, " under way: try again")};
}

// Returns the memory that results may take when they are read: eight times their bytes, as for rows
// with short spectra, and an allowance for the smallest results.
std::uint64_t most_memory(std::size_t bytes) { return 8 * bytes + (16 << 20); }

class CompleteCall final : public ChunkReader<schema::CompleteChunk> {
 public:
  CompleteCall(grpc::CallbackServerContext* context, FarmService::Desk& desk,
               schema::CompleteReply* reply)
      : ChunkReader(context, desk.calls),
        desk_(desk),
        reply_(reply),
        leased_(desk.result_bytes),
        late_(desk.late_result_bytes) {
    start();
  }

 private:
  absl::Status take(schema::CompleteChunk& chunk) override {
    if (!begun_) {
      begun_ = true;
      worker_id_ = chunk.worker_id();
      fencing_token_ = chunk.fencing_token();
      expected_ = chunk.result_bytes();
      wants_job_ = chunk.wants_job();
      sweep_sha256_ = chunk.sweep_sha256();
      if (sweep_sha256_.size() > kHashText)
        return absl::InvalidArgumentError("a hash that is longer than a hash");
      holds_lease_ = desk_.leases->holds(worker_id_, fencing_token_);
      if (expected_ == 0 || expected_ > kMaxResultBytes)
        return absl::InvalidArgumentError(
            absl::StrCat("a result of ", expected_, " bytes, expected 1 to ", kMaxResultBytes));
    }
    // Nobody's bytes are kept who is not registered; of those without a lease less.
    if (!desk_.leases->knows(worker_id_))
      return absl::NotFoundError(absl::StrCat("unknown worker: register again"));
    if (bytes_.size() + chunk.piece().size() > expected_)
      return absl::InvalidArgumentError("more bytes than announced");
    if (!(holds_lease_ ? leased_ : late_).take(chunk.piece().size()))
      return busy(absl::StatusCode::kUnavailable, "results");
    bytes_ += chunk.piece();
    return absl::OkStatus();
  }

  // Checks of the result alone are made here, on gRPC's thread.
  absl::Status finish_reading() override {
    if (!begun_) return absl::InvalidArgumentError("an empty result");
    auto result = std::make_unique<schema::JobResult>();
    if (bytes_.size() != expected_) return damaged();
    absl::Status checked =
        check_wire_size(bytes_, *schema::JobResult::descriptor(), most_memory(bytes_.size()));
    if (checked.ok()) {
      if (!result->ParseFromString(bytes_)) return damaged();
      checked = check_plausible(*result);
      content_sha256_ = content_sha256(*result);
    } else if (absl::IsInvalidArgument(checked)) {
      return damaged();
    } else {
      checked = absl::InvalidArgumentError(absl::StrCat("result: ", checked.message()));
    }
    bytes_ = std::string();
    desk_.loop.post(
        CommitLoop::Kind::kWrites,
        [this, kept = std::move(result), checked](Farm& farm) -> absl::Status {
          ASSIGN_OR_RETURN(*reply_, farm.complete({.worker_id = worker_id_,
                                                   .fencing_token = fencing_token_,
                                                   .sweep_sha256 = sweep_sha256_,
                                                   .result = *kept,
                                                   .content_sha256 = content_sha256_,
                                                   .checked = checked}));
          return wants_job_ ? add_next_job(farm) : absl::OkStatus();
        },
        [this](const absl::Status& status) { end(status); });
    return absl::OkStatus();
  }

  // With the answer, in the same transaction. Who is refused learns why when it asks by itself.
  absl::Status add_next_job(Farm& farm) {
    schema::LeaseRequest request;
    request.set_worker_id(worker_id_);
    auto next = farm.lease(request);
    if (next.ok()) *reply_->mutable_next() = *std::move(next);
    return is_refusal(next.status()) ? absl::OkStatus() : next.status();
  }

  void let_go() override {
    bytes_ = std::string();
    leased_.release();
    late_.release();
  }

  static absl::Status damaged() {
    return absl::DataLossError("the result arrived damaged: send it again");
  }

  static constexpr std::size_t kHashText = 64;

  FarmService::Desk& desk_;
  schema::CompleteReply* reply_;
  Share leased_, late_;
  bool begun_ = false, holds_lease_ = false, wants_job_ = false;
  std::string worker_id_, sweep_sha256_, content_sha256_, bytes_;
  std::uint64_t fencing_token_ = 0, expected_ = 0;
};

class SubmitCall final : public ChunkReader<schema::SubmitChunk> {
 public:
  SubmitCall(grpc::CallbackServerContext* context, FarmService::Desk& desk,
             schema::SubmitReply* reply)
      : ChunkReader(context, desk.calls),
        desk_(desk),
        reply_(reply),
        place_(desk.submissions),
        room_(desk.submitted_bytes) {
    start();
  }

 private:
  absl::Status take(schema::SubmitChunk& chunk) override {
    switch (chunk.what_case()) {
      case schema::SubmitChunk::kSweep:
        return begin_sweep(*chunk.mutable_sweep());
      case schema::SubmitChunk::kAsset:
        return begin_asset(chunk.asset());
      case schema::SubmitChunk::kPiece:
        return assets_.empty() ? add_to_sweep(chunk.piece()) : add_to_asset(chunk.piece());
      case schema::SubmitChunk::WHAT_NOT_SET:
        break;
    }
    return absl::InvalidArgumentError("an empty piece of a submission");
  }

  void let_go() override {
    bytes_ = std::string();
    assets_.clear();
    place_.release();
    room_.release();
  }

  absl::Status begin_sweep(schema::SweepHeader& header) {
    if (sweep_bytes_ != 0 || header.size_bytes() == 0 || header.size_bytes() > kMaxSweepBytes)
      return absl::InvalidArgumentError(absl::StrCat(
          "a sweep of ", header.size_bytes(), " bytes, expected one of 1 to ", kMaxSweepBytes));
    if (!place_.take(1)) return busy(absl::StatusCode::kResourceExhausted, "submissions");
    sweep_bytes_ = header.size_bytes();
    physics_version_ = header.physics_version();
    if (header.has_prediction()) prediction_ = std::move(*header.mutable_prediction());
    if (header.has_priority()) priority_ = header.priority();
    return absl::OkStatus();
  }

  absl::Status add_to_sweep(const std::string& piece) {
    if (bytes_.size() + piece.size() > sweep_bytes_)
      return absl::InvalidArgumentError("a sweep's piece that was not announced");
    bytes_ += piece;
    return absl::OkStatus();
  }

  absl::Status begin_asset(const schema::AssetHeader& header) {
    RETURN_IF_ERROR(end_last_piece());
    if (header.size_bytes() > kMaxAssetBytes)
      return absl::InvalidArgumentError(
          absl::StrCat("a model of ", header.size_bytes(), " bytes; at most ", kMaxAssetBytes));
    if (assets_.size() >= kMostAssets || header.sha256().size() > 64)
      return absl::InvalidArgumentError(
          absl::StrCat("more than ", kMostAssets, " files, or one with a wrong hash"));
    ASSIGN_OR_RETURN(auto file, SpooledFile::make(desk_.folder));
    assets_.push_back({header.sha256(), "", std::move(file)});
    asset_bytes_ = header.size_bytes();
    return absl::OkStatus();
  }

  absl::Status add_to_asset(const std::string& piece) {
    SpooledFile& file = *assets_.back().file;
    if (file.size() + piece.size() > asset_bytes_)
      return absl::InvalidArgumentError("an asset's piece that was not announced");
    if (!room_.take(piece.size())) return busy(absl::StatusCode::kResourceExhausted, "submissions");
    return file.append(piece);
  }

  absl::Status end_last_piece() const {
    if (sweep_bytes_ == 0 || bytes_.size() != sweep_bytes_ ||
        (!assets_.empty() && assets_.back().file->size() != asset_bytes_))
      return absl::InvalidArgumentError("a submission that was cut");
    return absl::OkStatus();
  }

  // Checks, hashes and keys take long: neither gRPC nor the commit loop is held up by them.
  absl::Status finish_reading() override {
    RETURN_IF_ERROR(end_last_piece());
    const bool posted = desk_.clerk.post([this] {
      if (auto status = safely([&] { return submit(); }); !status.ok()) end(status);
    });
    return posted ? absl::OkStatus() : absl::UnavailableError("the coordinator is shutting down");
  }

  absl::Status submit() {
    schema::ResolvedSweep sweep;
    if (auto status =
            check_wire_size(bytes_, *schema::ResolvedSweep::descriptor(), kMostSweepMemory);
        !status.ok())
      return absl::InvalidArgumentError(absl::StrCat("the sweep: ", status.message()));
    if (!sweep.ParseFromString(bytes_))
      return absl::InvalidArgumentError("the sweep arrived damaged");
    bytes_ = std::string();
    ASSIGN_OR_RETURN(auto made, make_submission(desk_.check_sweep, std::move(sweep),
                                                physics_version_, std::move(assets_)));
    made.prediction = std::move(prediction_);
    made.priority = priority_;
    desk_.loop.post(
        CommitLoop::Kind::kWrites,
        [this, submission = std::move(made)](Farm& farm) -> absl::Status {
          ASSIGN_OR_RETURN(*reply_, farm.submit(submission));
          return absl::OkStatus();
        },
        [this](const absl::Status& status) { end(status); });
    return absl::OkStatus();
  }

  static constexpr std::size_t kMostAssets = 1001;  // a model and its temperature fields
  // 10^5 conditions with their weather take 200 MB.
  static constexpr std::uint64_t kMostSweepMemory = 1 << 30;

  FarmService::Desk& desk_;
  schema::SubmitReply* reply_;
  Share place_, room_;
  std::string bytes_;
  std::uint64_t sweep_bytes_ = 0, asset_bytes_ = 0;
  std::uint32_t physics_version_ = 0;
  std::optional<schema::Prediction> prediction_;
  std::optional<int> priority_;
  std::vector<Asset> assets_;
};

class FetchCall final : public grpc::ServerWriteReactor<schema::AssetChunk>,
                        private OpenCalls::Call {
 public:
  FetchCall(grpc::CallbackServerContext* context, FarmService::Desk& desk, std::string sha256)
      : context_(context), calls_(desk.calls) {
    desk.loop.post(
        CommitLoop::Kind::kReads,
        [this, sha = std::move(sha256)](Farm& farm) -> absl::Status {
          ASSIGN_OR_RETURN(bytes_, farm.asset(sha));
          return absl::OkStatus();
        },
        [this](const absl::Status& status) {
          if (!status.ok()) return Finish(to_grpc(status));
          calls_.add(*this);
          send();
        });
  }
  ~FetchCall() override { calls_.remove(*this); }
  void OnWriteDone(bool ok) override {
    calls_.moved(*this, chunk_.piece().size());
    ok ? send() : Finish(grpc::Status(grpc::StatusCode::CANCELLED, "the receiver went away"));
  }
  void OnDone() override { delete this; }

 private:
  void cancel() override { context_->TryCancel(); }
  void send() {
    if (sent_ >= bytes_->size()) return Finish(grpc::Status::OK);
    chunk_.set_piece(bytes_->substr(sent_, kFetchedPieceBytes));
    sent_ += chunk_.piece().size();
    StartWrite(&chunk_);
  }

  grpc::CallbackServerContext* context_;
  OpenCalls& calls_;
  std::shared_ptr<const std::string> bytes_;
  std::size_t sent_ = 0;
  schema::AssetChunk chunk_;
};

const std::set<Role> kWorks = {Role::kWork};
const std::set<Role> kSubmits = {Role::kSubmit};
const std::set<Role> kLooks = {Role::kSubmit, Role::kRead};
const std::set<Role> kFetches = {Role::kWork, Role::kRead};

}  // namespace

using Kind = CommitLoop::Kind;

grpc::ServerUnaryReactor* FarmService::Register(grpc::CallbackServerContext* context,
                                                const schema::RegisterRequest* request,
                                                schema::RegisterReply* reply) {
  if (auto status = desk_.door->admit(*context, "Register", kWorks); !status.ok())
    return refuse(context, status);
  return answer(desk_.loop, Kind::kWrites, context, reply,
                [request](Farm& farm) { return farm.register_worker(*request); });
}

grpc::ServerUnaryReactor* FarmService::Lease(grpc::CallbackServerContext* context,
                                             const schema::LeaseRequest* request,
                                             schema::LeaseReply* reply) {
  if (auto status = desk_.door->admit(*context, "Lease", kWorks); !status.ok())
    return refuse(context, status);
  return answer(desk_.loop, Kind::kLeases, context, reply,
                [request](Farm& farm) { return farm.lease(*request); });
}

grpc::ServerUnaryReactor* FarmService::Heartbeat(grpc::CallbackServerContext* context,
                                                 const schema::HeartbeatRequest* request,
                                                 schema::HeartbeatReply* reply) {
  if (auto status = desk_.door->admit(*context, "Heartbeat", kWorks); !status.ok())
    return refuse(context, status);
  return answer(desk_.loop, Kind::kReads, context, reply,
                [request](Farm& farm) { return farm.heartbeat(*request); });
}

grpc::ServerReadReactor<schema::CompleteChunk>* FarmService::Complete(
    grpc::CallbackServerContext* context, schema::CompleteReply* reply) {
  if (auto status = desk_.door->admit(*context, "Complete", kWorks); !status.ok())
    return new RefusedStream<grpc::ServerReadReactor<schema::CompleteChunk>>(status);
  return new CompleteCall(context, desk_, reply);
}

grpc::ServerUnaryReactor* FarmService::Fail(grpc::CallbackServerContext* context,
                                            const schema::FailRequest* request,
                                            schema::FailReply* reply) {
  if (auto status = desk_.door->admit(*context, "Fail", kWorks); !status.ok())
    return refuse(context, status);
  return answer(desk_.loop, Kind::kWrites, context, reply,
                [request](Farm& farm) -> absl::StatusOr<schema::FailReply> {
                  RETURN_IF_ERROR(farm.fail(*request));
                  return schema::FailReply();
                });
}

grpc::ServerWriteReactor<schema::AssetChunk>* FarmService::FetchAsset(
    grpc::CallbackServerContext* context, const schema::FetchAssetRequest* request) {
  if (auto status = desk_.door->admit(*context, "FetchAsset", kFetches); !status.ok())
    return new RefusedStream<grpc::ServerWriteReactor<schema::AssetChunk>>(status);
  return new FetchCall(context, desk_, request->sha256());
}

grpc::ServerReadReactor<schema::SubmitChunk>* FarmService::Submit(
    grpc::CallbackServerContext* context, schema::SubmitReply* reply) {
  if (auto status = desk_.door->admit(*context, "Submit", kSubmits); !status.ok())
    return new RefusedStream<grpc::ServerReadReactor<schema::SubmitChunk>>(status);
  return new SubmitCall(context, desk_, reply);
}

grpc::ServerUnaryReactor* FarmService::Status(grpc::CallbackServerContext* context,
                                              const schema::StatusRequest* /*request*/,
                                              schema::StatusReply* reply) {
  if (auto status = desk_.door->admit(*context, "Status", kLooks); !status.ok())
    return refuse(context, status);
  return answer(desk_.loop, Kind::kReads, context, reply, [this](Farm& farm) {
    auto status = farm.status();
    if (status.ok())
      for (const std::string& warning : desk_.door->warnings()) status->add_warning(warning);
    return status;
  });
}

grpc::ServerUnaryReactor* FarmService::Cancel(grpc::CallbackServerContext* context,
                                              const schema::CancelRequest* request,
                                              schema::CancelReply* reply) {
  if (auto status = desk_.door->admit(*context, "Cancel", kSubmits); !status.ok())
    return refuse(context, status);
  return answer(desk_.loop, Kind::kWrites, context, reply,
                [request](Farm& farm) { return farm.cancel(request->sweep_sha256()); });
}

grpc::ServerUnaryReactor* FarmService::Prioritize(grpc::CallbackServerContext* context,
                                                  const schema::PrioritizeRequest* request,
                                                  schema::PrioritizeReply* reply) {
  if (auto status = desk_.door->admit(*context, "Prioritize", kSubmits); !status.ok())
    return refuse(context, status);
  return answer(desk_.loop, Kind::kWrites, context, reply,
                [request](Farm& farm) { return farm.prioritize(*request); });
}

}  // namespace irsig
