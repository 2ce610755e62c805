#include "coordinator/client/farm_client.h"

#include <grpcpp/client_context.h>

#include "absl/strings/str_cat.h"
#include "coordinator/client/channel.h"
#include "coordinator/client/fetch_asset.h"
#include "coordinator/client/handshake.h"
#include "core/base/status_macros.h"
#include "schema/farm.grpc.pb.h"

namespace irsig {
namespace {

constexpr double kStoringAViewpoint_s = 1e-3;  // 0.07 ms, and busy machines and disks

std::unique_ptr<schema::Farm::Stub> stub_for(const Address& coordinator) {
  return schema::Farm::NewStub(connect(coordinator));
}

absl::Status named(const absl::Status& status, const Address& coordinator) {
  if (!is_unreachable(status)) return status;
  RETURN_IF_ERROR(check_handshake(coordinator));
  return absl::UnavailableError(
      absl::StrCat("no coordinator answers at ", coordinator.text, " (", status.message(), ")"));
}

// A question and its answer.
template <class Request, class Reply>
absl::StatusOr<Reply> ask(const Address& coordinator,
                          grpc::Status (schema::Farm::Stub::*call)(grpc::ClientContext*,
                                                                   const Request&, Reply*),
                          const Request& request, double patience_s) {
  const auto farm = stub_for(coordinator);
  grpc::ClientContext context;
  set_deadline(context, patience_s);
  Reply reply;
  const auto status = to_absl(((*farm).*call)(&context, request, &reply));
  if (!status.ok()) return named(status, coordinator);
  return reply;
}

absl::StatusOr<std::string> sha256_of_sweep(const Address& coordinator,
                                            std::string_view name_or_sha256, double patience_s) {
  ASSIGN_OR_RETURN(const auto known, farm_status(coordinator, patience_s));
  std::string sha256, names;
  for (const auto& sweep : known.sweep()) {
    const bool prefix =
        name_or_sha256.size() >= 8 && sweep.sweep_sha256().starts_with(name_or_sha256);
    if (prefix || sweep.name() == name_or_sha256) sha256 = sweep.sweep_sha256();
    absl::StrAppend(&names, names.empty() ? "" : ", ", sweep.name());
  }
  if (sha256.empty()) {
    return absl::NotFoundError(absl::StrCat("no sweep \"", std::string(name_or_sha256), "\" at ",
                                            coordinator.text, "; there ",
                                            names.empty() ? "is none" : "are: ", names));
  }
  return sha256;
}

}  // namespace

absl::StatusOr<schema::SubmitReply> submit(const Address& coordinator,
                                           const schema::ResolvedSweep& sweep, const Assets& assets,
                                           std::uint32_t physics_version,
                                           const schema::Prediction* prediction,
                                           std::optional<int> priority, double patience_s) {
  const auto channel = connect(coordinator);
  if (!channel->WaitForConnected(deadline(patience_s)))
    return named(absl::UnavailableError("no connection"), coordinator);
  const auto farm = schema::Farm::NewStub(channel);
  grpc::ClientContext context;
  set_deadline(context, patience_s + kStoringAViewpoint_s * sweep.viewpoint_size());
  context.set_wait_for_ready(true);
  schema::SubmitReply reply;
  const auto stream = farm->Submit(&context, &reply);
  const std::string sweep_bytes = sweep.SerializeAsString();
  schema::SubmitChunk chunk;
  chunk.mutable_sweep()->set_size_bytes(sweep_bytes.size());
  chunk.mutable_sweep()->set_physics_version(physics_version);
  if (prediction != nullptr) *chunk.mutable_sweep()->mutable_prediction() = *prediction;
  if (priority) chunk.mutable_sweep()->set_priority(*priority);
  bool open = stream->Write(chunk);
  const auto write_pieces = [&](std::string_view bytes) {
    for (std::size_t at = 0; open && at < bytes.size(); at += kPieceBytes) {
      schema::SubmitChunk piece;
      piece.set_piece(std::string(bytes.substr(at, kPieceBytes)));
      open = stream->Write(piece);
    }
  };
  write_pieces(sweep_bytes);
  for (const std::string& sha256 : needed_assets(sweep)) {
    if (!open) break;
    const std::string_view bytes = asset(assets, sha256);
    schema::SubmitChunk header;
    header.mutable_asset()->set_sha256(sha256);
    header.mutable_asset()->set_size_bytes(bytes.size());
    open = stream->Write(header);
    write_pieces(bytes);
  }
  stream->WritesDone();
  if (const auto status = to_absl(stream->Finish()); !status.ok()) {
    return named(status, coordinator);
  }
  return reply;
}

absl::StatusOr<schema::StatusReply> farm_status(const Address& coordinator, double patience_s) {
  return ask(coordinator, &schema::Farm::Stub::Status, schema::StatusRequest(), patience_s);
}

absl::StatusOr<schema::CancelReply> cancel(const Address& coordinator,
                                           std::string_view sweep_name_or_sha256,
                                           double patience_s) {
  ASSIGN_OR_RETURN(auto sha256, sha256_of_sweep(coordinator, sweep_name_or_sha256, patience_s));
  schema::CancelRequest request;
  request.set_sweep_sha256(std::move(sha256));
  return ask(coordinator, &schema::Farm::Stub::Cancel, request, patience_s);
}

absl::Status prioritize(const Address& coordinator, std::string_view sweep_name_or_sha256,
                        int priority, double patience_s) {
  ASSIGN_OR_RETURN(auto sha256, sha256_of_sweep(coordinator, sweep_name_or_sha256, patience_s));
  schema::PrioritizeRequest request;
  request.set_sweep_sha256(std::move(sha256));
  request.set_priority(priority);
  return ask(coordinator, &schema::Farm::Stub::Prioritize, request, patience_s).status();
}

absl::StatusOr<schema::ResolvedSweep> stored_sweep(const Address& coordinator,
                                                   const std::string& sweep_sha256,
                                                   double patience_s) {
  const auto farm = stub_for(coordinator);
  auto sweep = fetch_sweep(*farm, sweep_sha256, patience_s);
  if (!sweep.ok()) return named(sweep.status(), coordinator);
  return sweep;
}

}  // namespace irsig
