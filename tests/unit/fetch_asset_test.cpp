// Bytes from a coordinator are compared with the hash that was asked for: over a socket, with a
// coordinator that sends what it likes.
#include "coordinator/client/fetch_asset.h"

#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "coordinator/client/channel.h"
#include "jobs/keys/expand.h"
#include "tests/fault/synthetic_farm.h"

namespace irsig {
namespace {

class Sender final : public schema::Farm::Service {
 public:
  grpc::Status FetchAsset(grpc::ServerContext* /*context*/,
                          const schema::FetchAssetRequest* /*request*/,
                          grpc::ServerWriter<schema::AssetChunk>* writer) override {
    for (const std::string& piece : pieces) {
      schema::AssetChunk chunk;
      chunk.set_piece(piece);
      writer->Write(chunk);
    }
    return ending;
  }
  std::vector<std::string> pieces;
  grpc::Status ending;
};

class FetchAsset : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = testing::TempDir() + "/irsig-fetch-XXXXXX";
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    const std::string socket = "unix:" + folder_ + "/farm";
    grpc::ServerBuilder builder;
    builder.AddListeningPort(socket, grpc::InsecureServerCredentials());
    builder.RegisterService(&sender_);
    server_ = builder.BuildAndStart();
    ASSERT_NE(server_, nullptr);
    farm_ = schema::Farm::NewStub(connect(*parse_address(socket)));
  }
  void TearDown() override {
    farm_.reset();
    if (server_) server_->Shutdown();
    std::filesystem::remove_all(folder_);
  }
  absl::StatusOr<std::string> file(const std::string& sha256) {
    return fetch_file(*farm_, sha256, 20);
  }

  std::string folder_;
  Sender sender_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<schema::Farm::Stub> farm_;
};

TEST_F(FetchAsset, AFileIsThatOfItsHash) {
  const std::string sha256 = sha256_hex("the model");
  sender_.pieces = {"the ", "", "model"};
  const auto whole = file(sha256);
  ASSERT_TRUE(whole.ok()) << whole.status();
  EXPECT_EQ(*whole, "the model");
  for (const std::vector<std::string>& wrong : std::vector<std::vector<std::string>>{
           {}, {"the "}, {"model", "the "}, {"the model", "x"}, {"the modem"}}) {
    sender_.pieces = wrong;
    EXPECT_TRUE(absl::IsDataLoss(file(sha256).status())) << wrong.size();
  }
  sender_.pieces = {"the model"};
  sender_.ending = {grpc::StatusCode::UNAVAILABLE, "gone"};
  EXPECT_TRUE(absl::IsUnavailable(file(sha256).status()));
}

TEST_F(FetchAsset, ASweepIsThatOfItsHash) {
  const schema::ResolvedSweep sweep = frigate_sweep(2);
  const std::string sha256 = sha256_hex(canonical_encoding(sweep));
  const std::string bytes = sweep.SerializeAsString();
  sender_.pieces = {bytes};
  const auto whole = fetch_sweep(*farm_, sha256, 20);
  ASSERT_TRUE(whole.ok()) << whole.status();
  EXPECT_EQ(canonical_encoding(*whole), canonical_encoding(sweep));
  for (const std::string& wrong : {std::string(), bytes.substr(0, bytes.size() / 2),
                                   frigate_sweep(3).SerializeAsString(), "\xff\xff" + bytes}) {
    sender_.pieces = {wrong};
    EXPECT_TRUE(absl::IsDataLoss(fetch_sweep(*farm_, sha256, 20).status())) << wrong.size();
  }
}

}  // namespace
}  // namespace irsig
