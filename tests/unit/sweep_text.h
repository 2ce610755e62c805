#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "jobs/files/material_files.h"
#include "jobs/files/weather_files.h"
#include "jobs/resolve_sweep.h"
#include "jobs/text/sweep_file.h"

namespace irsig {

inline std::string text_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  EXPECT_TRUE(in) << path << " cannot be read";
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

// A sweep file and the model file that it names, resolved.
inline absl::StatusOr<schema::ResolvedSweep> resolved_file(const std::filesystem::path& path) {
  absl::StatusOr<SweepFile> file = parse_sweep(text_of(path), path.string());
  if (!file.ok()) return file.status();
  const auto read = [&](const std::string& name) -> absl::StatusOr<std::string> {
    return text_of(path.parent_path() / name);
  };
  if (const absl::Status status = read_material_files(*file, read); !status.ok()) return status;
  if (const absl::Status status = read_weather_files(*file, read); !status.ok()) return status;
  std::string model;
  if (file->sweep.model().has_file())
    model = text_of(path.parent_path() / file->sweep.model().file());
  return resolve_sweep(*file, model);
}

inline absl::StatusOr<schema::ResolvedSweep> resolved_text(const std::string& text) {
  absl::StatusOr<SweepFile> file = parse_sweep(text, "s.toml");
  if (!file.ok()) return file.status();
  return resolve_sweep(*file, "");
}

}  // namespace irsig
