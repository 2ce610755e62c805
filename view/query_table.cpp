#include "view/query_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "view/progress.h"
#include "view/quantity.h"

namespace irsig {
namespace {

struct RowColumn {
  Column column;
  std::function<Cell(const QueryRow&)> cell;
};

template <typename T>
RowColumn stored(const char* name, T StoredSignature::*field, bool brief) {
  return {{name, brief}, [field](const QueryRow& row) -> Cell {
            if constexpr (std::is_same_v<T, std::uint32_t>) {
              return static_cast<std::uint64_t>(row.signature.*field);
            } else if constexpr (std::is_same_v<T, double>) {
              // What was not computed is no number.
              const double value = row.signature.*field;
              return std::isnan(value) ? Cell() : Cell(value);
            } else if constexpr (std::is_same_v<T, std::optional<std::uint64_t>>) {
              return row.signature.*field ? Cell(*(row.signature.*field)) : Cell();
            } else {
              return row.signature.*field;
            }
          }};
}

// What an interpolated row does not have: it was not computed.
template <typename T>
RowColumn computed(const char* name, T StoredSignature::*field, bool brief) {
  RowColumn out = stored(name, field, brief);
  out.cell = [inner = std::move(out.cell)](const QueryRow& row) -> Cell {
    return row.interpolation ? Cell() : inner(row);
  };
  return out;
}

using S = StoredSignature;

// The catalogue's quantities from one of them to another, both included ("": to its end). What
// belongs to one computation alone an interpolated row does not have.
std::vector<RowColumn> quantities(std::string_view first, std::string_view last) {
  std::vector<RowColumn> out;
  bool inside = false;
  for (std::size_t i = 0; i < kQuantities.size(); ++i) {
    const QuantityInfo& q = kQuantities[i];
    inside |= q.name == first;
    const bool own = q.kind == QuantityKind::kBound || q.kind == QuantityKind::kGoal;
    if (inside)
      out.push_back(own ? computed(q.name.data(), kQuantityMember[i], false)
                        : stored(q.name.data(), kQuantityMember[i], false));
    if (q.name == last) break;
  }
  return out;
}

// The columns that scripts rely on, in their fixed order.
std::vector<RowColumn> fixed_columns(bool with_totals) {
  std::vector<RowColumn> out{
      computed("row", &S::row, true),
      stored("sweep", &S::sweep, false),
      stored("season", &S::season, true),
      stored("time_utc", &S::time_utc, true),
      stored("band", &S::band, true),
      stored("aspect_azimuth_deg", &S::aspect_azimuth_deg, true),
      stored("aspect_elevation_deg", &S::aspect_elevation_deg, true),
      stored("range_m", &S::range_m, true),
  };
  for (RowColumn& c : quantities("intensity_w_sr", "apparent_temperature_k")) {
    c.column.brief = with_totals && c.column.name != "projected_area_stderr_m2";
    out.push_back(std::move(c));
  }
  // 0 K stands for "no projected area": there is no such temperature.
  out.back().cell = [](const QueryRow& row) -> Cell {
    if (row.signature.apparent_temperature_k == 0) return Cell();
    return row.signature.apparent_temperature_k;
  };
  return out;
}

std::vector<RowColumn> interpolation_columns() {
  return {{{"interpolation_error_w_sr", true},
           [](const QueryRow& row) -> Cell {
             return row.interpolation ? Cell(row.interpolation->interpolation_error_w_sr) : Cell();
           }},
          {{"viewpoints_used", false}, [](const QueryRow& row) -> Cell {
             return row.interpolation
                        ? Cell(static_cast<std::uint64_t>(row.interpolation->from.size()))
                        : Cell();
           }}};
}

// The range that a moved row was computed at, and what moving it added to its error.
std::vector<RowColumn> range_columns() {
  return {{{"stored_range_m", true},
           [](const QueryRow& row) -> Cell {
             return row.range_change ? Cell(row.range_change->stored_range_m) : Cell();
           }},
          {{"range_bound_w_sr", true}, [](const QueryRow& row) -> Cell {
             return row.range_change ? Cell(row.range_change->range_bound_w_sr) : Cell();
           }}};
}

std::vector<RowColumn> cause_columns() {
  std::vector<RowColumn> out = quantities("emitted_w_sr", "parts_reflected_stderr_w_sr");
  for (RowColumn& c : out) c.column.brief = c.column.name.find("stderr") == std::string::npos;
  return out;
}

std::vector<RowColumn> further_columns() {
  std::vector<RowColumn> out = quantities("apparent_intensity_w_sr", "path_radiance_w_m2_sr");
  const auto append = [&](std::vector<RowColumn> more) {
    out.insert(out.end(), std::make_move_iterator(more.begin()),
               std::make_move_iterator(more.end()));
  };
  append({
      stored("lambda_min_um", &S::lambda_min_um, false),
      stored("lambda_max_um", &S::lambda_max_um, false),
      stored("sun_azimuth_deg", &S::sun_azimuth_deg, false),
      stored("sun_zenith_deg", &S::sun_zenith_deg, false),
  });
  append(quantities("truncation_bound_w_sr", ""));
  append({
      {{"dominant_inputs", false},
       [](const QueryRow& row) -> Cell {
         const std::string& named = row.signature.dominant_inputs;
         return row.interpolation || named.empty() ? Cell() : Cell(named);
       }},
      computed("reflections", &S::reflections, false),
      computed("stop_reason", &S::stop_reason, false),
      stored("warning", &S::warning, false),
      stored("energy_gain", &S::energy_gain, false),
      computed("samples", &S::samples, false),
      computed("replicates", &S::replicates, false),
      computed("target_paths", &S::target_paths, false),
      computed("rays", &S::rays, false),
      computed("seconds", &S::seconds, false),
      computed("guarded_backface_hits", &S::guarded_backface_hits, false),
      computed("guarded_nonfinite", &S::guarded_nonfinite, false),
      computed("guarded_path_limit", &S::guarded_path_limit, false),
      computed("guarded_negative", &S::guarded_negative, false),
      computed("job_key", &S::job_key, false),
      computed("seed_hex", &S::seed_hex, false),
      stored("physics_version", &S::physics_version, false),
      stored("determinism_class", &S::determinism_class, false),
      stored("build_id", &S::build_id, false),
  });
  return out;
}

// People see the quantity that they asked about, and beside another than the source intensity only
// the value of that.
void show_quantity(std::vector<RowColumn>& columns, const QuantityColumns& asked) {
  if (asked.quantity == SignatureQuantity::kIntensity) return;
  const QuantityColumns& source = columns_of(SignatureQuantity::kIntensity);
  for (RowColumn& c : columns) {
    if (c.column.name == source.stderr_name || c.column.name == source.error_name)
      c.column.brief = false;
    if (c.column.name == asked.value_name || c.column.name == asked.stderr_name ||
        c.column.name == asked.error_name)
      c.column.brief = true;
  }
}

// Empty cells come last, whichever way round.
bool before(const Cell& a, const Cell& b, bool descending) {
  const bool a_empty = std::holds_alternative<std::monostate>(a);
  const bool b_empty = std::holds_alternative<std::monostate>(b);
  if (a_empty || b_empty) return b_empty && !a_empty;
  return descending ? b < a : a < b;
}

std::vector<Cell> cells_of(const std::vector<RowColumn>& columns, const QueryRow& row) {
  std::vector<Cell> out;
  for (const RowColumn& c : columns) out.push_back(c.cell(row));
  return out;
}

using Sp = schema::Spectrum;
constexpr SpectralColumn kSpectral[] = {
    {"spectral_intensity_w_sr_um", &Sp::spectral_intensity_w_sr_um},
    {"spectral_intensity_stderr_w_sr_um", &Sp::spectral_intensity_stderr_w_sr_um},
    {"apparent_spectral_intensity_w_sr_um", &Sp::apparent_spectral_intensity_w_sr_um},
    {"apparent_spectral_intensity_stderr_w_sr_um", &Sp::apparent_spectral_intensity_stderr_w_sr_um},
    {"contrast_spectral_intensity_w_sr_um", &Sp::contrast_spectral_intensity_w_sr_um},
    {"contrast_spectral_intensity_stderr_w_sr_um", &Sp::contrast_spectral_intensity_stderr_w_sr_um},
    {"background_radiance_w_m2_sr_um", &Sp::background_radiance_w_m2_sr_um},
    {"background_radiance_stderr_w_m2_sr_um", &Sp::background_radiance_stderr_w_m2_sr_um},
    {"path_transmittance", &Sp::path_transmittance},
    {"path_radiance_w_m2_sr_um", &Sp::path_radiance_w_m2_sr_um},
};
constexpr SpectralColumn kSpectralCauses[] = {
    {"spectral_emitted_w_sr_um", &Sp::emitted_w_sr_um},
    {"spectral_emitted_stderr_w_sr_um", &Sp::emitted_stderr_w_sr_um},
    {"spectral_sun_reflected_w_sr_um", &Sp::sun_reflected_w_sr_um},
    {"spectral_sun_reflected_stderr_w_sr_um", &Sp::sun_reflected_stderr_w_sr_um},
    {"spectral_sky_reflected_w_sr_um", &Sp::sky_reflected_w_sr_um},
    {"spectral_sky_reflected_stderr_w_sr_um", &Sp::sky_reflected_stderr_w_sr_um},
    {"spectral_sea_reflected_w_sr_um", &Sp::sea_reflected_w_sr_um},
    {"spectral_sea_reflected_stderr_w_sr_um", &Sp::sea_reflected_stderr_w_sr_um},
    {"spectral_parts_reflected_w_sr_um", &Sp::parts_reflected_w_sr_um},
    {"spectral_parts_reflected_stderr_w_sr_um", &Sp::parts_reflected_stderr_w_sr_um},
};

Cell value_at(const google::protobuf::RepeatedField<float>& values, int k) {
  return k < values.size() ? Cell(static_cast<double>(values.Get(k))) : Cell();
}

absl::Status write_spectra(StoreReader& reader, const std::vector<QueryRow>& rows,
                           std::vector<RowColumn> base, const QueryContent& content,
                           std::string_view format, std::ostream& out) {
  const bool causes = content.causes;
  const QuantityColumns& asked = columns_of(content.quantity);
  std::vector<Column> columns;
  for (const RowColumn& c : base) columns.push_back(c.column);
  columns.push_back({"lambda_um"});
  for (const auto& c : kSpectral) {
    columns.push_back(
        {c.name, c.values == asked.spectral_value || c.values == asked.spectral_stderr});
  }
  if (causes) {
    for (const auto& c : kSpectralCauses) {
      columns.push_back(
          {c.name, std::string_view(c.name).find("stderr") == std::string_view::npos});
    }
  }
  const bool interpolated = !rows.empty() && rows.front().interpolation.has_value();
  if (interpolated) columns.push_back({"spectral_interpolation_error_w_sr_um"});
  auto writer = make_table_writer(format, columns, out);
  if (!writer.ok()) return writer.status();
  LoopProgress progress("spectra written, rows", rows.size());
  for (const QueryRow& row : rows) {
    progress.step();
    auto got = spectrum_of(reader, row);
    if (!got.ok()) return got.status();
    const schema::Spectrum& spectrum = got->spectrum;
    const std::vector<Cell> cells = cells_of(base, row);
    for (int k = 0; k < spectrum.lambda_um_size(); ++k) {
      std::vector<Cell> line = cells;
      line.emplace_back(spectrum.lambda_um(k));
      for (const auto& c : kSpectral) line.push_back(value_at((spectrum.*c.values)(), k));
      if (causes) {
        for (const auto& c : kSpectralCauses) line.push_back(value_at((spectrum.*c.values)(), k));
      }
      if (interpolated) {
        line.emplace_back(got->spectral_interpolation_error_w_sr_um[static_cast<std::size_t>(k)]);
      }
      (*writer)->row(line);
    }
  }
  return (*writer)->finish();
}

absl::Status write_parts(StoreReader& reader, const std::vector<QueryRow>& rows,
                         std::vector<RowColumn> base, std::string_view format, std::ostream& out) {
  std::vector<Column> columns;
  for (const RowColumn& c : base) columns.push_back(c.column);
  for (const char* name : {"part", "part_intensity_w_sr", "part_intensity_stderr_w_sr"}) {
    columns.push_back({name});
  }
  const bool interpolated = !rows.empty() && rows.front().interpolation.has_value();
  if (interpolated) columns.push_back({"part_interpolation_error_w_sr"});
  auto writer = make_table_writer(format, columns, out);
  if (!writer.ok()) return writer.status();
  LoopProgress progress("parts written, rows", rows.size());
  for (const QueryRow& row : rows) {
    progress.step();
    auto parts = parts_of(reader, row);
    if (!parts.ok()) return parts.status();
    const std::vector<Cell> cells = cells_of(base, row);
    for (const RowPart& p : *parts) {
      std::vector<Cell> line = cells;
      line.emplace_back(p.part.part);
      line.emplace_back(p.part.intensity_w_sr);
      line.emplace_back(p.part.intensity_stderr_w_sr);
      if (interpolated) line.emplace_back(p.interpolation_error_w_sr);
      (*writer)->row(line);
    }
  }
  return (*writer)->finish();
}

}  // namespace

std::span<const SpectralColumn> spectral_causes() { return kSpectralCauses; }

absl::Status sort_rows(std::vector<QueryRow>& rows, std::string_view column, bool descending) {
  std::vector<RowColumn> columns = fixed_columns(true);
  for (auto&& more : {cause_columns(), further_columns()})
    columns.insert(columns.end(), more.begin(), more.end());
  // As CSV calls it, or as people read it in the heading: "intensity", "numerical error".
  const auto named = [&](const RowColumn& c) { return c.column.name == column; };
  const auto headed = [&](const RowColumn& c) {
    std::string asked(column);
    std::replace(asked.begin(), asked.end(), '_', ' ');
    return quantity_of(c.column.name).noun == asked;
  };
  auto by = std::find_if(columns.begin(), columns.end(), named);
  if (by == columns.end()) by = std::find_if(columns.begin(), columns.end(), headed);
  if (by == columns.end()) {
    std::vector<std::string_view> names;
    for (const RowColumn& c : columns) names.push_back(c.column.name);
    return absl::InvalidArgumentError(fmt::format("no column \"{}\" to sort by: expected one of {}",
                                                  column, fmt::join(names, ", ")));
  }
  std::stable_sort(rows.begin(), rows.end(), [&](const QueryRow& a, const QueryRow& b) {
    return before(by->cell(a), by->cell(b), descending);
  });
  return absl::OkStatus();
}

absl::Status write_in_band(const std::vector<QueryRow>& rows, const std::vector<InBand>& sum,
                           SignatureQuantity quantity, std::string_view format, std::ostream& out) {
  struct Of {
    const char* prefix;
    Measured InBand::*measured;
    SignatureQuantity quantity;
  };
  constexpr Of kAll[] = {
      {"in_band_", &InBand::source, SignatureQuantity::kIntensity},
      {"in_band_apparent_", &InBand::apparent, SignatureQuantity::kApparentIntensity},
      {"in_band_contrast_", &InBand::contrast, SignatureQuantity::kContrastIntensity}};
  std::vector<RowColumn> columns = fixed_columns(false);
  if (!rows.empty() && rows.front().range_change) {
    std::vector<RowColumn> more = range_columns();
    std::move(more.begin(), more.end(), std::back_inserter(columns));
  }
  std::vector<Column> heads;
  for (const RowColumn& c : columns) heads.push_back(c.column);
  for (const Of& of : kAll) {
    const bool brief = of.quantity == quantity;
    const std::string prefix = of.prefix;
    heads.push_back({prefix + "intensity_w_sr", true});
    heads.push_back({prefix + "intensity_stderr_w_sr", brief});
    heads.push_back({prefix + "bound_w_sr", false});
    heads.push_back({prefix + "numerical_error_w_sr", brief});
  }
  heads.push_back({"errors_from", true});
  auto writer = make_table_writer(format, heads, out);
  if (!writer.ok()) return writer.status();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::vector<Cell> line = cells_of(columns, rows[i]);
    for (const Of& of : kAll) {
      const Measured& m = sum[i].*of.measured;
      line.emplace_back(m.value);
      line.emplace_back(m.stderr_);
      line.emplace_back(m.bias_bound());
      line.emplace_back(m.numerical_error());
    }
    line.emplace_back(std::string(sum[i].modes ? "modes" : "all as one"));
    (*writer)->row(line);
  }
  return (*writer)->finish();
}

absl::Status write_rows(StoreReader& reader, const std::vector<QueryRow>& rows,
                        const QueryContent& content, std::string_view format, std::ostream& out) {
  if (content.parts && content.quantity != SignatureQuantity::kIntensity) {
    return absl::InvalidArgumentError(
        fmt::format("parts: only their source intensity is stored, expected quantity intensity and "
                    "not {}",
                    columns_of(content.quantity).name));
  }
  if (content.spectrum && content.parts) {
    return absl::InvalidArgumentError("spectrum and parts cannot be written into one table");
  }
  const bool by_line = content.spectrum || content.parts;
  std::vector<RowColumn> columns = fixed_columns(!by_line);
  const bool several = std::any_of(rows.begin(), rows.end(), [&](const QueryRow& r) {
    return r.signature.sweep != rows.front().signature.sweep;
  });
  for (RowColumn& c : columns)
    if (c.column.name == "sweep") c.column.brief = several;
  const bool uncertain = std::any_of(rows.begin(), rows.end(), [](const QueryRow& r) {
    return !std::isnan(r.signature.input_uncertainty_w_sr);
  });
  const auto append = [&](std::vector<RowColumn> more) {
    columns.insert(columns.end(), std::make_move_iterator(more.begin()),
                   std::make_move_iterator(more.end()));
  };
  if (!rows.empty() && rows.front().range_change) append(range_columns());
  if (content.spectrum) {
    return write_spectra(reader, rows, std::move(columns), content, format, out);
  }
  if (!content.parts && !rows.empty() && rows.front().interpolation)
    append(interpolation_columns());
  if (content.causes) append(cause_columns());
  if (content.parts) return write_parts(reader, rows, std::move(columns), format, out);
  append(further_columns());
  show_quantity(columns, columns_of(content.quantity));
  const bool plume = std::any_of(rows.begin(), rows.end(), [](const QueryRow& r) {
    return !std::isnan(r.signature.plume_w_sr);
  });
  for (RowColumn& c : columns)
    if (plume && c.column.name == "plume_w_sr") c.column.brief = true;
  const char* input_name = columns_of(content.quantity).input_name;
  for (RowColumn& c : columns)
    if (uncertain && input_name != nullptr && c.column.name == input_name) c.column.brief = true;

  std::vector<Column> heads;
  for (const RowColumn& c : columns) heads.push_back(c.column);
  auto writer = make_table_writer(format, heads, out);
  if (!writer.ok()) return writer.status();
  LoopProgress progress("rows written", rows.size());
  for (const QueryRow& row : rows) {
    (*writer)->row(cells_of(columns, row));
    progress.step();
  }
  return (*writer)->finish();
}

}  // namespace irsig
