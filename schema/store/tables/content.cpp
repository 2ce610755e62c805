#include "schema/store/tables/content.h"

#include "google/protobuf/io/coded_stream.h"
#include "google/protobuf/io/zero_copy_stream_impl_lite.h"
#include "schema/store/tables/sha256.h"

namespace irsig {

std::string content_sha256(schema::JobResult& result) {
  const double seconds = result.seconds();
  std::string build_id;
  build_id.swap(*result.mutable_build_id());
  result.clear_seconds();
  std::string bytes;
  {
    google::protobuf::io::StringOutputStream stream(&bytes);
    google::protobuf::io::CodedOutputStream coded(&stream);
    coded.SetSerializationDeterministic(true);
    result.SerializeToCodedStream(&coded);
  }
  result.set_seconds(seconds);
  result.mutable_build_id()->swap(build_id);
  return sha256_of(bytes);
}

std::string content_sha256(const schema::JobResult& result) {
  schema::JobResult copy = result;
  return content_sha256(copy);
}

}  // namespace irsig
