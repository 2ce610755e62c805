#include "coordinator/client/fetch_asset.h"

#include <grpcpp/client_context.h>

#include "absl/strings/str_cat.h"
#include "coordinator/client/channel.h"
#include "core/base/status_macros.h"
#include "jobs/keys/expand.h"

namespace irsig {
namespace {

absl::StatusOr<std::string> fetch_asset(schema::Farm::StubInterface& farm,
                                        const std::string& sha256, double patience_s) {
  grpc::ClientContext context;
  set_deadline(context, patience_s);
  schema::FetchAssetRequest request;
  request.set_sha256(sha256);
  const auto stream = farm.FetchAsset(&context, request);
  std::string bytes;
  schema::AssetChunk chunk;
  while (stream->Read(&chunk)) bytes += chunk.piece();
  RETURN_IF_ERROR(to_absl(stream->Finish()));
  return bytes;
}

}  // namespace

absl::StatusOr<schema::ResolvedSweep> fetch_sweep(schema::Farm::StubInterface& farm,
                                                  const std::string& sweep_sha256,
                                                  double patience_s) {
  ASSIGN_OR_RETURN(const auto bytes, fetch_asset(farm, sweep_sha256, patience_s));
  // The hash is that of the canonical encoding, which does not depend on how protobuf writes it.
  schema::ResolvedSweep sweep;
  if (!sweep.ParseFromString(bytes) || sha256_hex(canonical_encoding(sweep)) != sweep_sha256) {
    return absl::DataLossError(absl::StrCat("the sweep ", sweep_sha256, " arrived damaged"));
  }
  return sweep;
}

absl::StatusOr<std::string> fetch_file(schema::Farm::StubInterface& farm, const std::string& sha256,
                                       double patience_s) {
  auto bytes = fetch_asset(farm, sha256, patience_s);
  if (bytes.ok() && sha256_hex(*bytes) != sha256) {
    return absl::DataLossError(absl::StrCat("the file ", sha256, " arrived damaged"));
  }
  return bytes;
}

}  // namespace irsig
