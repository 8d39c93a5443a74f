#include "experiments/store/header.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string_view>

#include "experiments/store/bytes.hpp"
#include "experiments/store/crc64.hpp"

namespace loam::experiments {
namespace {

constexpr std::size_t longest_attribute = 32000;  // an HDF5 attribute ends at 64 kB, its header included

void require_header(bool condition, const std::string& message) {
    if (!condition) throw std::invalid_argument("EnsembleHeader: " + message);
}

void check_text(std::string_view text, std::string_view what) {
    require_header(text.find('\0') == std::string_view::npos, fmt::format("{} holds a byte 0", what));
}

template <typename Columns>
void check_names(const Columns& columns, std::string_view what) {
    std::set<std::string_view> seen;
    for (const auto& column : columns) {
        require_header(!column.name.empty(), fmt::format("a {} has no name", what));
        require_header(seen.insert(column.name).second,
                       fmt::format("the {} '{}' is there twice", what, column.name));
        check_text(column.name, what);
        check_text(column.unit, what);
    }
}

std::string shown(const std::string& text) {
    constexpr std::size_t longest = 60;
    if (text.empty()) return "empty";
    return "'" + (text.size() > longest ? text.substr(0, longest) + "..." : text) + "'";
}

std::string shown(const ParameterColumn& column) {
    return fmt::format("{} from {} to {} {}", column.name, column.lower, column.upper, column.unit);
}

std::string shown(const OutputColumn& column) {
    return fmt::format("{}: {} {} at {} = {} {}", column.file, column.channel, column.unit, column.x_channel,
                       column.x, column.x_unit);
}

std::string shown(const DiagnosticColumn& column) {
    return fmt::format("{} {}", column.name, column.unit);
}

/// At most one sentence a table: the first difference says enough.
template <typename Column>
void compare_columns(std::string_view what, const std::vector<Column>& there, const std::vector<Column>& here,
                     std::vector<std::string>& found) {
    if (there.size() != here.size()) {
        found.push_back(fmt::format("there are {} {}s there and {} here", there.size(), what, here.size()));
        return;
    }
    for (std::size_t i = 0; i < there.size(); ++i) {
        if (there[i] == here[i]) continue;
        found.push_back(
            fmt::format("{} {} is '{}' there and '{}' here", what, i + 1, shown(there[i]), shown(here[i])));
        return;
    }
}

void compare_attributes(const std::map<std::string, std::string>& there,
                        const std::map<std::string, std::string>& here, std::vector<std::string>& found) {
    std::set<std::string> names;
    for (const auto& [name, value] : there) names.insert(name);
    for (const auto& [name, value] : here) names.insert(name);
    for (const std::string& name : names) {
        const auto a = there.find(name);
        const auto b = here.find(name);
        const std::string left = a == there.end() ? "not set" : shown(a->second);
        const std::string right = b == here.end() ? "not set" : shown(b->second);
        if (a != there.end() && b != here.end() && a->second == b->second) continue;
        found.push_back(left == right ? fmt::format("'{}' differs", name)
                                      : fmt::format("'{}' is {} there and {} here", name, left, right));
    }
}

}  // namespace

void validate(const EnsembleHeader& header) {
    require_header(!header.parameters.empty(), "parameters must not be empty");
    require_header(!header.outputs.empty(), "outputs must not be empty");
    check_names(header.parameters, "parameter");
    check_names(header.diagnostics, "diagnostic");
    for (const ParameterColumn& column : header.parameters)
        require_header(!std::isnan(column.lower) && !std::isnan(column.upper),
                       fmt::format("a bound of '{}' is not a number", column.name));
    for (const OutputColumn& column : header.outputs) {
        for (const std::string* text :
             {&column.file, &column.channel, &column.unit, &column.x_channel, &column.x_unit})
            check_text(*text, "an output");
        require_header(!column.channel.empty(), "an output has no channel");
        require_header(!std::isnan(column.x),
                       fmt::format("x of output '{}' is not a number", column.channel));
    }
    for (const auto& [name, value] : header.attributes) {
        require_header(!name.empty(), "an attribute has no name");
        require_header(name != "campaign_seed" && name != "format" && name != "format_version",
                       fmt::format("the attribute '{}' is the store's own", name));
        require_header(value.size() <= longest_attribute,
                       fmt::format("the attribute '{}' is longer than {} bytes", name, longest_attribute));
        check_text(name, "an attribute's name");
        check_text(value, fmt::format("the attribute '{}'", name));
    }
}

std::vector<std::string> differences(const EnsembleHeader& there, const EnsembleHeader& here) {
    std::vector<std::string> found;
    if (there.campaign_seed != here.campaign_seed)
        found.push_back(fmt::format("the campaign seed is {} there and {} here", there.campaign_seed,
                                    here.campaign_seed));
    compare_columns("parameter", there.parameters, here.parameters, found);
    compare_columns("output", there.outputs, here.outputs, found);
    compare_columns("diagnostic", there.diagnostics, here.diagnostics, found);
    compare_attributes(there.attributes, here.attributes, found);
    return found;
}

std::uint64_t fingerprint(const EnsembleHeader& header) {
    ByteWriter writer;
    writer.number(store_format_version);
    writer.number(header.campaign_seed);
    writer.number(static_cast<std::uint64_t>(header.parameters.size()));
    for (const ParameterColumn& column : header.parameters) {
        writer.text(column.name);
        writer.text(column.unit);
        writer.number(column.lower + 0.0);  // -0.0 is 0.0
        writer.number(column.upper + 0.0);
    }
    writer.number(static_cast<std::uint64_t>(header.outputs.size()));
    for (const OutputColumn& column : header.outputs) {
        for (const std::string* text :
             {&column.file, &column.channel, &column.unit, &column.x_channel, &column.x_unit})
            writer.text(*text);
        writer.number(column.x + 0.0);
    }
    writer.number(static_cast<std::uint64_t>(header.diagnostics.size()));
    for (const DiagnosticColumn& column : header.diagnostics) {
        writer.text(column.name);
        writer.text(column.unit);
    }
    for (const auto& [name, value] : header.attributes) {
        writer.text(name);
        writer.text(value);
    }
    return crc64(writer.bytes());
}

}  // namespace loam::experiments
