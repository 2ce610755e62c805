#include "view/query/query_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <utility>

#include "core/base/status_macros.h"
#include "view/base/progress.h"
#include "view/base/quantity.h"

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
              // A value that was not computed (NaN) gives an empty cell.
              const double value = row.signature.*field;
              return std::isnan(value) ? Cell() : Cell(value);
            } else if constexpr (std::is_same_v<T, std::optional<std::uint64_t>>) {
              return row.signature.*field ? Cell(*(row.signature.*field)) : Cell();
            } else {
              return row.signature.*field;
            }
          }};
}

// Returns a column that is empty for interpolated rows, for which its value was not computed.
template <typename T>
RowColumn computed(const char* name, T StoredSignature::*field, bool brief) {
  RowColumn out = stored(name, field, brief);
  out.cell = [inner = std::move(out.cell)](const QueryRow& row) -> Cell {
    return row.interpolation ? Cell() : inner(row);
  };
  return out;
}

using S = StoredSignature;

// A text that not every row has: an empty one is no value.
RowColumn if_named(const char* name, std::string StoredSignature::*field) {
  return {{name, false}, [field](const QueryRow& row) -> Cell {
            const std::string& named = row.signature.*field;
            return row.interpolation || named.empty() ? Cell() : Cell(named);
          }};
}

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
// 0 K stands for "no projected area": there is no such temperature.
Cell temperature_cell(double kelvin) { return kelvin == 0 ? Cell() : Cell(kelvin); }

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
  for (RowColumn& c : quantities("intensity_w_sr", "source_radiance_temperature_k")) {
    c.column.brief = with_totals && c.column.name != "projected_area_stderr_m2";
    out.push_back(std::move(c));
  }
  out.back().cell = [](const QueryRow& row) {
    return temperature_cell(row.signature.source_radiance_temperature_k);
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
  std::vector<RowColumn> out = quantities("emitted_w_sr", "interreflected_stderr_w_sr");
  for (RowColumn& c : out) c.column.brief = c.column.name.find("stderr") == std::string::npos;
  return out;
}

std::vector<RowColumn> further_columns() {
  std::vector<RowColumn> out = quantities("apparent_intensity_w_sr", "path_radiance_w_m2_sr");
  for (RowColumn& c : out)
    if (c.column.name == "apparent_temperature_k")
      c.cell = [](const QueryRow& row) {
        return temperature_cell(row.signature.apparent_temperature_k);
      };
  const auto append = [&](std::vector<RowColumn> more) {
    out.insert(out.end(), std::make_move_iterator(more.begin()),
               std::make_move_iterator(more.end()));
  };
  append({
      stored("lambda_min_um", &S::lambda_min_um, false),
      stored("lambda_max_um", &S::lambda_max_um, false),
      stored("mean_solar_time", &S::mean_solar_time, true),
      stored("sun_azimuth_deg", &S::sun_azimuth_deg, false),
      stored("sun_zenith_deg", &S::sun_zenith_deg, false),
  });
  append(quantities("truncation_bound_w_sr", ""));
  append({
      if_named("dominant_inputs", &S::dominant_inputs),
      computed("reflections", &S::reflections, false),
      computed("stop_reason", &S::stop_reason, false),
      if_named("limiting_bound", &S::limiting_bound),
      stored("warning", &S::warning, false),
      stored("energy_gain", &S::energy_gain, false),
      computed("samples", &S::samples, false),
      computed("replicates", &S::replicates, false),
      computed("target_paths", &S::target_paths, false),
      computed("rays", &S::rays, false),
      computed("seconds", &S::seconds, false),
      computed("guarded_backface_hits", &S::guarded_backface_hits, false),
      computed("guarded_nonfinite", &S::guarded_nonfinite, false),
      computed("truncated_paths", &S::truncated_paths, false),
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
    {"spectral_surface_reflected_w_sr_um", &Sp::surface_reflected_w_sr_um},
    {"spectral_surface_reflected_stderr_w_sr_um", &Sp::surface_reflected_stderr_w_sr_um},
    {"spectral_interreflected_w_sr_um", &Sp::interreflected_w_sr_um},
    {"spectral_interreflected_stderr_w_sr_um", &Sp::interreflected_stderr_w_sr_um},
};

Cell value_at(const google::protobuf::RepeatedField<float>& values, int k) {
  return k < values.size() ? Cell(static_cast<double>(values.Get(k))) : Cell();
}

// One line for each wavelength.
class LongSpectra {
 public:
  LongSpectra(const QueryContent& content, bool interpolated)
      : causes_(content.causes), interpolated_(interpolated) {}

  void add_heads(const QuantityColumns& asked, std::vector<Column>& heads) const {
    heads.push_back({"lambda_um"});
    for (const auto& c : kSpectral)
      heads.push_back(
          {c.name, c.values == asked.spectral_value || c.values == asked.spectral_stderr});
    if (causes_)
      for (const auto& c : kSpectralCauses)
        heads.push_back(
            {c.name, std::string_view(c.name).find("stderr") == std::string_view::npos});
    if (interpolated_) heads.push_back({"spectral_interpolation_error_w_sr_um"});
  }

  void write(const std::vector<Cell>& cells, const RowSpectrum& row, TableWriter& out) const {
    const Sp& spectrum = row.spectrum;
    for (int k = 0; k < spectrum.lambda_um_size(); ++k) {
      std::vector<Cell> line = cells;
      line.emplace_back(spectrum.lambda_um(k));
      for (const auto& c : kSpectral) line.push_back(value_at((spectrum.*c.values)(), k));
      if (causes_)
        for (const auto& c : kSpectralCauses) line.push_back(value_at((spectrum.*c.values)(), k));
      if (interpolated_)
        line.emplace_back(row.spectral_interpolation_error_w_sr_um[static_cast<std::size_t>(k)]);
      out.row(line);
    }
  }

 private:
  bool causes_, interpolated_;
};

// One column for each wavelength: of the quantity's spectrum and of its standard error.
class WideSpectra {
 public:
  WideSpectra(const QuantityColumns& asked, const Sp& first)
      : asked_(asked), lambda_um_(first.lambda_um().begin(), first.lambda_um().end()) {}

  void add_heads(std::vector<Column>& heads) const {
    for (const auto values : {asked_.spectral_value, asked_.spectral_stderr})
      for (const double lambda_um : lambda_um_)
        for (const auto& c : kSpectral)
          if (c.values == values) heads.push_back({fmt::format("{}_at_{:g}um", c.name, lambda_um)});
  }

  absl::Status write(std::vector<Cell> line, const QueryRow& row, const Sp& spectrum,
                     TableWriter& out) const {
    const auto& axis = spectrum.lambda_um();
    if (!std::equal(axis.begin(), axis.end(), lambda_um_.begin(), lambda_um_.end()))
      return absl::InvalidArgumentError(fmt::format(
          "row {} of sweep {} has other wavelengths than the first: a wide table has one "
          "set of them, expected --band",
          row.signature.row, row.signature.sweep));
    for (const auto values : {asked_.spectral_value, asked_.spectral_stderr})
      for (int k = 0; k < axis.size(); ++k) line.push_back(value_at((spectrum.*values)(), k));
    out.row(line);
    return absl::OkStatus();
  }

 private:
  const QuantityColumns& asked_;
  std::vector<double> lambda_um_;
};

template <typename Keep>
bool any_row(const std::vector<QueryRow>& rows, const Keep& keep) {
  return std::any_of(rows.begin(), rows.end(), keep);
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
  ASSIGN_OR_RETURN(auto writer, make_table_writer(format, heads, out));
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
    writer->row(line);
  }
  return writer->finish();
}

struct RowTable::Parts {
  StoreReader& reader;
  QueryContent content;
  bool interpolated = false;
  std::vector<RowColumn> columns;
  std::optional<LongSpectra> spectra;
  std::optional<WideSpectra> wide;
  std::unique_ptr<TableWriter> writer;

  std::vector<Column> heads() const {
    std::vector<Column> out;
    for (const RowColumn& c : columns) out.push_back(c.column);
    return out;
  }
  void append(std::vector<RowColumn> more) {
    columns.insert(columns.end(), std::make_move_iterator(more.begin()),
                   std::make_move_iterator(more.end()));
  }
  // Adds the columns of whole rows, unless a spectrum or parts make several lines of each row.
  void add_totals(const std::vector<QueryRow>& first) {
    append(further_columns());
    show_quantity(columns, columns_of(content.quantity));
    const bool plume =
        any_row(first, [](const QueryRow& r) { return !std::isnan(r.signature.plume_w_sr); });
    const bool clutter =
        any_row(first, [](const QueryRow& r) { return !std::isnan(r.signature.clutter_window_m); });
    const bool uncertain = any_row(
        first, [](const QueryRow& r) { return !std::isnan(r.signature.input_uncertainty_w_sr); });
    const bool model = any_row(
        first, [](const QueryRow& r) { return !std::isnan(r.signature.heat_model_error_w_sr); });
    const char* input_name = columns_of(content.quantity).input_name;
    for (RowColumn& c : columns) {
      if (plume && c.column.name == "plume_w_sr") c.column.brief = true;
      if (clutter && c.column.name == "clutter_patch_sigma_w_m2_sr") c.column.brief = true;
      if (model && c.column.name == "heat_model_error_w_sr") c.column.brief = true;
      if (uncertain && input_name != nullptr && c.column.name == input_name) c.column.brief = true;
    }
  }

  absl::Status write_row(const QueryRow& row) {
    const std::vector<Cell> cells = cells_of(columns, row);
    if (content.parts) {
      ASSIGN_OR_RETURN(const auto parts, parts_of(reader, row));
      for (const RowPart& p : parts) {
        std::vector<Cell> line = cells;
        line.emplace_back(p.part.part);
        line.emplace_back(p.part.intensity_w_sr);
        line.emplace_back(p.part.intensity_stderr_w_sr);
        if (interpolated) line.emplace_back(p.interpolation_error_w_sr);
        writer->row(line);
      }
      return absl::OkStatus();
    }
    if (!spectra && !wide) {
      writer->row(cells);
      return absl::OkStatus();
    }
    ASSIGN_OR_RETURN(const auto got, spectrum_of(reader, row));
    if (wide) return wide->write(cells, row, got.spectrum, *writer);
    spectra->write(cells, got, *writer);
    return absl::OkStatus();
  }
};

RowTable::RowTable(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
RowTable::RowTable(RowTable&&) noexcept = default;
RowTable& RowTable::operator=(RowTable&&) noexcept = default;
RowTable::~RowTable() = default;

absl::StatusOr<RowTable> RowTable::make(StoreReader& reader, const std::vector<QueryRow>& first,
                                        const QueryContent& content, std::string_view format,
                                        std::ostream& out) {
  if (content.parts && content.quantity != SignatureQuantity::kIntensity) {
    return absl::InvalidArgumentError(
        fmt::format("parts: only their source intensity is stored, expected quantity intensity and "
                    "not {}",
                    columns_of(content.quantity).name));
  }
  const bool spectrum = content.spectrum || content.wide;
  if (spectrum && content.parts) {
    return absl::InvalidArgumentError("spectrum and parts cannot be written into one table");
  }
  auto parts = std::make_unique<Parts>(Parts{
      reader, content, !first.empty() && first.front().interpolation.has_value(), {}, {}, {}, {}});
  parts->columns = fixed_columns(!spectrum && !content.parts);
  const bool several = any_row(
      first, [&](const QueryRow& r) { return r.signature.sweep != first.front().signature.sweep; });
  for (RowColumn& c : parts->columns)
    if (c.column.name == "sweep") c.column.brief = several;
  if (!first.empty() && first.front().range_change) parts->append(range_columns());
  if (!spectrum) {
    if (!content.parts && parts->interpolated) parts->append(interpolation_columns());
    if (content.causes) parts->append(cause_columns());
    if (!content.parts) parts->add_totals(first);
  }
  std::vector<Column> heads = parts->heads();
  if (content.parts) {
    for (const char* name : {"part", "part_intensity_w_sr", "part_intensity_stderr_w_sr"})
      heads.push_back({name});
    if (parts->interpolated) heads.push_back({"part_interpolation_error_w_sr"});
  } else if (content.wide) {
    Sp axis;
    if (!first.empty()) {
      ASSIGN_OR_RETURN(const auto got, spectrum_of(reader, first.front()));
      axis = got.spectrum;
    }
    parts->wide.emplace(columns_of(content.quantity), axis);
    parts->wide->add_heads(heads);
  } else if (content.spectrum) {
    parts->spectra.emplace(content, parts->interpolated);
    parts->spectra->add_heads(columns_of(content.quantity), heads);
  }
  ASSIGN_OR_RETURN(auto writer, make_table_writer(format, heads, out));
  parts->writer = std::move(writer);
  return RowTable(std::move(parts));
}

absl::Status RowTable::write(const QueryRow& row) { return parts_->write_row(row); }
absl::Status RowTable::finish() { return parts_->writer->finish(); }

absl::Status write_rows(StoreReader& reader, const std::vector<QueryRow>& rows,
                        const QueryContent& content, std::string_view format, std::ostream& out) {
  ASSIGN_OR_RETURN(auto table, RowTable::make(reader, rows, content, format, out));
  LoopProgress progress("rows written", rows.size());
  for (const QueryRow& row : rows) {
    RETURN_IF_ERROR(table.write(row));
    progress.step();
  }
  return table.finish();
}

}  // namespace irsig
