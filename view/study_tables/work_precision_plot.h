#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace irsig {

// Errors against work, both logarithmic.
struct WorkSeries {
  std::string name;          // in the legend
  std::vector<double> x, y;  // equal lengths; values that are not positive and finite are left out
  bool joined = true;        // by a line
};

struct WorkPanel {
  std::string title, x_label, y_label;
  std::vector<WorkSeries> series;
  double reference_error = 0;  // > 0: upper end of a grey band, the error of the reference
  std::vector<double> target;  // dashed lines across
};

// Panels side by side, `columns` in a row, each with its legend, as a complete SVG document.
[[nodiscard]] std::string plot_work_precision(std::string_view title, std::string_view subtitle,
                                              const std::vector<WorkPanel>& panels,
                                              std::size_t columns);

struct PageTable {
  std::string caption;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> row;
};

struct PageSection {
  std::string heading;
  std::vector<std::string> paragraph;
  std::string svg;  // of plot_work_precision; empty: none
  std::vector<PageTable> table;
};

// Returns an HTML document without external resources: pictures are inline, and there are no
// scripts.
[[nodiscard]] std::string html_page(const std::string& title,
                                    const std::vector<PageSection>& sections);

// Returns the tables as Markdown.
[[nodiscard]] std::string markdown_tables(const std::vector<PageTable>& tables);

}  // namespace irsig
