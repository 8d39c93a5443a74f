// The texts of which a report is made (page, style, scripts, the Vega library), embedded when the program is
// built: a report can be written on a machine that has neither the source tree nor Vega installed.
#pragma once

#include <span>
#include <string_view>

namespace loam::experiments::report {

struct Asset {
    std::string_view name;  // "template.html", "style.css", or a script's module name, as in assets.cmake
    std::string_view text;
};

// All assets in the order of assets.cmake. The memory is static.
std::span<const Asset> embedded_assets();

}  // namespace loam::experiments::report
