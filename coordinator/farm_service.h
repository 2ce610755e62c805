#pragma once

#include <memory>
#include <string>
#include <utility>

#include "coordinator/background_thread.h"
#include "coordinator/commit_loop.h"
#include "coordinator/doorkeeper.h"
#include "coordinator/limits.h"
#include "coordinator/open_calls.h"
#include "schema/farm.grpc.pb.h"

namespace irsig {

// Connects gRPC to the commit loop; no call holds a thread while it waits for its commit. The
// memory of a call is reserved before it is allocated. A client that takes too long between two
// pieces is disconnected.
class FarmService final : public schema::Farm::CallbackService {
 public:
  // State that all calls share.
  struct Desk {
    Desk(CommitLoop& commit_loop, std::string of_database, SweepCheck check)
        : loop(commit_loop), folder(std::move(of_database)), check_sweep(std::move(check)) {}

    CommitLoop& loop;
    std::string folder;  // of the database: files on their way into it are kept there
    SweepCheck check_sweep;
    const LeaseBook* leases = nullptr;
    Doorkeeper* door = nullptr;
    SharedLimit result_bytes{512 << 20};
    SharedLimit late_result_bytes{256 << 20};  // of workers without their lease
    SharedLimit submissions{4};
    SharedLimit submitted_bytes{8'000'000'000};
    OpenCalls calls;
    BackgroundThread clerk;
  };

  FarmService(CommitLoop& loop, std::string folder, SweepCheck check_sweep)
      : desk_(loop, std::move(folder), std::move(check_sweep)) {}

  // Sets the lease book and the doorkeeper; must be called before the first call arrives.
  void use(const LeaseBook& leases, Doorkeeper& door) {
    desk_.leases = &leases;
    desk_.door = &door;
  }
  // Refuses further submissions. Called before the loop stops.
  void stop() { desk_.clerk.stop(); }

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
  grpc::ServerUnaryReactor* Prioritize(grpc::CallbackServerContext* context,
                                       const schema::PrioritizeRequest* request,
                                       schema::PrioritizeReply* reply) override;

 private:
  Desk desk_;
};

}  // namespace irsig
