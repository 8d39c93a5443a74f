// The report of a run: one HTML file with charts (Vega) that opens offline and asks no server for anything.
// What it shows is decided by the document's members alone; report/README.md lists them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace loam::experiments {

// The whole file as UTF-8 text. `document` is an object in SI units as report/README.md describes; a member
// that is absent leaves its section out, a number that is null or not finite leaves a gap, and text is shown
// as it is, whatever it contains. The same document gives the same bytes. Throws std::invalid_argument when
// `document` is not an object or has no text `verb` or `name`.
std::string report_html(const nlohmann::json& document);

}  // namespace loam::experiments
