#pragma once

#include "coordinator/commit_loop.h"
#include "schema/farm.grpc.pb.h"

namespace irsig {

// gRPC on one side, the commit loop on the other: no call holds a thread while it waits for its
// commit.
class FarmService final : public schema::Farm::CallbackService {
 public:
  explicit FarmService(CommitLoop& loop) : loop_(loop) {}

  grpc::ServerUnaryReactor* Register(grpc::CallbackServerContext* context,
                                     const schema::RegisterRequest* request,
                                     schema::RegisterReply* reply) override;
  grpc::ServerUnaryReactor* Lease(grpc::CallbackServerContext* context,
                                  const schema::LeaseRequest* request,
                                  schema::LeaseReply* reply) override;
  grpc::ServerUnaryReactor* Heartbeat(grpc::CallbackServerContext* context,
                                      const schema::HeartbeatRequest* request,
                                      schema::HeartbeatReply* reply) override;
  grpc::ServerReadReactor<schema::CompleteChunk>* Complete(grpc::CallbackServerContext* context,
                                                           schema::CompleteReply* reply) override;
  grpc::ServerUnaryReactor* Fail(grpc::CallbackServerContext* context,
                                 const schema::FailRequest* request,
                                 schema::FailReply* reply) override;
  grpc::ServerWriteReactor<schema::AssetChunk>* FetchAsset(
      grpc::CallbackServerContext* context, const schema::FetchAssetRequest* request) override;
  grpc::ServerReadReactor<schema::SubmitChunk>* Submit(grpc::CallbackServerContext* context,
                                                       schema::SubmitReply* reply) override;
  grpc::ServerUnaryReactor* Status(grpc::CallbackServerContext* context,
                                   const schema::StatusRequest* request,
                                   schema::StatusReply* reply) override;
  grpc::ServerUnaryReactor* Cancel(grpc::CallbackServerContext* context,
                                   const schema::CancelRequest* request,
                                   schema::CancelReply* reply) override;

 private:
  CommitLoop& loop_;
};

}  // namespace irsig
