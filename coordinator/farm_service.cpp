#include "coordinator/farm_service.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "coordinator/client/channel.h"

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
        auto got = ask(farm);
        if (!got.ok()) return got.status();
        *reply = *std::move(got);
        return absl::OkStatus();
      },
      [reactor](const absl::Status& status) { reactor->Finish(to_grpc(status)); });
  return reactor;
}

// Reads a stream of chunks to its end, then finishes once. The derived class takes the chunks; it
// deletes itself when gRPC is done with it.
template <class Chunk>
class ChunkReader : public grpc::ServerReadReactor<Chunk> {
 public:
  explicit ChunkReader(grpc::CallbackServerContext* context) : context_(context) {}

  void OnReadDone(bool ok) override {
    if (ok) {
      if (auto status = take(chunk_); !status.ok()) return this->Finish(to_grpc(status));
      chunk_.Clear();
      return this->StartRead(&chunk_);
    }
    if (context_->IsCancelled()) {
      return this->Finish(grpc::Status(grpc::StatusCode::CANCELLED, "the sender went away"));
    }
    finish_reading();
  }
  void OnDone() override { delete this; }

 protected:
  void start() { this->StartRead(&chunk_); }
  virtual absl::Status take(Chunk& chunk) = 0;
  virtual void finish_reading() = 0;  // must lead to Finish

 private:
  grpc::CallbackServerContext* context_;
  Chunk chunk_;
};

class CompleteCall final : public ChunkReader<schema::CompleteChunk> {
 public:
  CompleteCall(grpc::CallbackServerContext* context, CommitLoop& loop)
      : ChunkReader(context), loop_(loop) {
    start();
  }

 private:
  absl::Status take(schema::CompleteChunk& chunk) override {
    if (bytes_.empty()) {
      worker_id_ = chunk.worker_id();
      fencing_token_ = chunk.fencing_token();
      expected_ = chunk.result_bytes();
      if (expected_ == 0 || expected_ > kMaxStreamBytes) {
        return absl::InvalidArgumentError(absl::StrCat("a result of ", expected_, " bytes"));
      }
      bytes_.reserve(std::min<std::size_t>(expected_, 16 * kPieceBytes));
    }
    bytes_ += chunk.piece();
    if (bytes_.size() > expected_) return absl::InvalidArgumentError("more bytes than announced");
    return absl::OkStatus();
  }

  void finish_reading() override {
    auto result = std::make_unique<schema::JobResult>();
    if (bytes_.size() != expected_ || !result->ParseFromString(bytes_)) {
      return Finish(to_grpc(absl::DataLossError("the result arrived damaged: send it again")));
    }
    bytes_ = std::string();
    loop_.post(
        CommitLoop::Kind::kWrites,
        [this, kept = std::move(result)](Farm& farm) {
          return farm.complete(worker_id_, fencing_token_, *kept);
        },
        [this](const absl::Status& status) { Finish(to_grpc(status)); });
  }

  CommitLoop& loop_;
  std::string worker_id_, bytes_;
  std::uint64_t fencing_token_ = 0, expected_ = 0;
};

class SubmitCall final : public ChunkReader<schema::SubmitChunk> {
 public:
  SubmitCall(grpc::CallbackServerContext* context, CommitLoop& loop, schema::SubmitReply* reply)
      : ChunkReader(context), loop_(loop), reply_(reply) {
    start();
  }

 private:
  absl::Status take(schema::SubmitChunk& chunk) override {
    switch (chunk.what_case()) {
      case schema::SubmitChunk::kSweep:
        sweep_ = std::move(*chunk.mutable_sweep());
        physics_version_ = chunk.physics_version();
        if (chunk.has_prediction()) prediction_ = std::move(*chunk.mutable_prediction());
        return absl::OkStatus();
      case schema::SubmitChunk::kAsset:
        if (chunk.asset().size_bytes() > kMaxStreamBytes) {
          return absl::InvalidArgumentError(absl::StrCat("a model of ", chunk.asset().size_bytes(),
                                                         " bytes; at most ", kMaxStreamBytes));
        }
        assets_.push_back({chunk.asset().sha256(), ""});
        sizes_.push_back(chunk.asset().size_bytes());
        return absl::OkStatus();
      case schema::SubmitChunk::kPiece:
        if (assets_.empty() || assets_.back().bytes.size() + chunk.piece().size() > sizes_.back()) {
          return absl::InvalidArgumentError("an asset's piece that was not announced");
        }
        assets_.back().bytes += chunk.piece();
        return absl::OkStatus();
      case schema::SubmitChunk::WHAT_NOT_SET:
        break;
    }
    return absl::InvalidArgumentError("an empty piece of a submission");
  }

  // Hashes and keys are worked out here, on gRPC's thread: the commit loop is not held up by them.
  void finish_reading() override {
    auto made = make_submission(std::move(sweep_), physics_version_, std::move(assets_));
    if (!made.ok()) return Finish(to_grpc(made.status()));
    made->prediction = std::move(prediction_);
    loop_.post(
        CommitLoop::Kind::kWrites,
        [this, submission = *std::move(made)](Farm& farm) -> absl::Status {
          auto got = farm.submit(submission);
          if (!got.ok()) return got.status();
          *reply_ = *std::move(got);
          return absl::OkStatus();
        },
        [this](const absl::Status& status) { Finish(to_grpc(status)); });
  }

  CommitLoop& loop_;
  schema::SubmitReply* reply_;
  schema::ResolvedSweep sweep_;
  std::uint32_t physics_version_ = 0;
  std::optional<schema::Prediction> prediction_;
  std::vector<Asset> assets_;
  std::vector<std::uint64_t> sizes_;
};

class FetchCall final : public grpc::ServerWriteReactor<schema::AssetChunk> {
 public:
  FetchCall(CommitLoop& loop, std::string sha256) {
    loop.post(
        CommitLoop::Kind::kReads,
        [this, sha = std::move(sha256)](Farm& farm) -> absl::Status {
          auto got = farm.asset(sha);
          if (!got.ok()) return got.status();
          bytes_ = *std::move(got);
          return absl::OkStatus();
        },
        [this](const absl::Status& status) { status.ok() ? send() : Finish(to_grpc(status)); });
  }
  void OnWriteDone(bool ok) override {
    ok ? send() : Finish(grpc::Status(grpc::StatusCode::CANCELLED, "the receiver went away"));
  }
  void OnDone() override { delete this; }

 private:
  void send() {
    if (sent_ >= bytes_->size()) return Finish(grpc::Status::OK);
    chunk_.set_piece(bytes_->substr(sent_, kPieceBytes));
    sent_ += chunk_.piece().size();
    StartWrite(&chunk_);
  }

  std::shared_ptr<const std::string> bytes_;
  std::size_t sent_ = 0;
  schema::AssetChunk chunk_;
};

}  // namespace

using Kind = CommitLoop::Kind;

grpc::ServerUnaryReactor* FarmService::Register(grpc::CallbackServerContext* context,
                                                const schema::RegisterRequest* request,
                                                schema::RegisterReply* reply) {
  return answer(loop_, Kind::kWrites, context, reply,
                [request](Farm& farm) { return farm.register_worker(*request); });
}

grpc::ServerUnaryReactor* FarmService::Lease(grpc::CallbackServerContext* context,
                                             const schema::LeaseRequest* request,
                                             schema::LeaseReply* reply) {
  return answer(loop_, Kind::kWrites, context, reply,
                [request](Farm& farm) { return farm.lease(*request); });
}

grpc::ServerUnaryReactor* FarmService::Heartbeat(grpc::CallbackServerContext* context,
                                                 const schema::HeartbeatRequest* request,
                                                 schema::HeartbeatReply* reply) {
  return answer(loop_, Kind::kReads, context, reply,
                [request](Farm& farm) { return farm.heartbeat(*request); });
}

grpc::ServerReadReactor<schema::CompleteChunk>* FarmService::Complete(
    grpc::CallbackServerContext* context, schema::CompleteReply* /*reply*/) {
  return new CompleteCall(context, loop_);
}

grpc::ServerUnaryReactor* FarmService::Fail(grpc::CallbackServerContext* context,
                                            const schema::FailRequest* request,
                                            schema::FailReply* reply) {
  return answer(loop_, Kind::kWrites, context, reply,
                [request](Farm& farm) -> absl::StatusOr<schema::FailReply> {
                  if (auto status = farm.fail(*request); !status.ok()) return status;
                  return schema::FailReply();
                });
}

grpc::ServerWriteReactor<schema::AssetChunk>* FarmService::FetchAsset(
    grpc::CallbackServerContext* /*context*/, const schema::FetchAssetRequest* request) {
  return new FetchCall(loop_, request->sha256());
}

grpc::ServerReadReactor<schema::SubmitChunk>* FarmService::Submit(
    grpc::CallbackServerContext* context, schema::SubmitReply* reply) {
  return new SubmitCall(context, loop_, reply);
}

grpc::ServerUnaryReactor* FarmService::Status(grpc::CallbackServerContext* context,
                                              const schema::StatusRequest* /*request*/,
                                              schema::StatusReply* reply) {
  return answer(loop_, Kind::kReads, context, reply, [](Farm& farm) { return farm.status(); });
}

grpc::ServerUnaryReactor* FarmService::Cancel(grpc::CallbackServerContext* context,
                                              const schema::CancelRequest* request,
                                              schema::CancelReply* reply) {
  return answer(loop_, Kind::kWrites, context, reply,
                [request](Farm& farm) { return farm.cancel(request->sweep_sha256()); });
}

}  // namespace irsig
