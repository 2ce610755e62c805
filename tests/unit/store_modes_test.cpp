// Modes of a spectrum's errors are stored as they came, and are no part of the digest.
#include "tests/unit/store_fixture.h"

namespace irsig {
namespace {

TEST(StoreModes, ComeBackAsTheyCameAndAreNoPartOfTheDigest) {
  const TestFolder folder;
  const std::string path = folder.file("a.sigdb");
  const schema::ResolvedSweep sweep = make_sweep({});
  std::map<std::string, schema::Spectrum> sent;
  {
    auto writer = StoreWriter::open(path).value();
    ASSERT_OK(submit(*writer, sweep, "sweep-a").status());
    ASSERT_OK(complete_jobs(*writer, sweep).status());
    for (const schema::JobSpec& job : make_jobs(sweep, "sweep-a")) {
      const schema::JobResult result = make_result(sweep, job);
      for (const schema::SignatureRow& row : result.view().row())
        sent[absl::StrCat(job.view().viewpoint_index(), " ", row.condition_index(), " ",
                          row.band_index())] = row.spectrum();
    }
    ASSERT_OK(writer->finish());
  }
  auto reader = StoreReader::open(path).value();
  const auto rows = reader->find({}).value();
  ASSERT_EQ(rows.size(), sent.size());
  const auto conditions = static_cast<std::uint64_t>(sweep.condition_size()),
             bands = static_cast<std::uint64_t>(sweep.sweep().band_size());
  for (const StoredSignature& s : rows) {
    const std::uint64_t place = s.row - 1;
    const schema::Spectrum& is = sent.at(absl::StrCat(
        place / bands / conditions, " ", place / bands % conditions, " ", place % bands));
    const schema::Spectrum got = reader->spectrum(s.signature_id).value();
    EXPECT_FALSE(got.apparent_spectral_intensity_modes().empty());
    EXPECT_EQ(got.SerializeAsString(), is.SerializeAsString());
  }
  const std::string digest = reader->digest().value();
  reader.reset();
  // Another set of modes, and a row that an older irsig stored: the same content.
  sqlite_text(path,
              "UPDATE spectral_modes SET spectral_intensity_modes = zeroblob(20) WHERE "
              "signature_id = 2");
  sqlite_text(path, "DELETE FROM spectral_modes WHERE signature_id = 1");
  reader = StoreReader::open(path).value();
  EXPECT_EQ(reader->digest().value(), digest);
  EXPECT_EQ(reader->spectrum(1).value().spectral_intensity_modes(), "");
  EXPECT_EQ(reader->spectrum(2).value().spectral_intensity_modes(), std::string(20, '\0'));
  reader.reset();
  sqlite_text(path,
              "UPDATE spectral_modes SET spectral_intensity_modes = x'01' WHERE "
              "signature_id = 3");
  EXPECT_TRUE(absl::IsDataLoss(StoreReader::open(path).value()->spectrum(3).status()));
}

}  // namespace
}  // namespace irsig
