#include "lab_data/nearest_name.hpp"

#include <algorithm>
#include <vector>

namespace loam::lab_data {
namespace {

constexpr std::size_t longest_compared =
    200;  // longer ones are no typing mistakes, and the distance is quadratic

std::string folded(std::string_view name) {
    std::string text(name);
    for (char& c : text) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
        if (c == '-' || c == ' ') c = '_';
    }
    return text;
}

}  // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
    // Rows i-2, i-1 and i of the table of distances between prefixes.
    std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t substitution = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, substitution});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                row[j] = std::min(row[j], before[j - 2] + 1);
        }
        before.swap(last);
        last.swap(row);
    }
    return last[b.size()];
}

std::optional<std::string> nearest_name(std::string_view name, std::span<const std::string_view> valid) {
    if (name.empty() || name.size() > longest_compared) return std::nullopt;
    const std::string wanted = folded(name);
    std::optional<std::string> nearest;
    std::size_t least = 0;
    for (const std::string_view candidate : valid) {
        const std::size_t distance = edit_distance(wanted, folded(candidate));
        if (distance > std::max(wanted.size(), candidate.size()) / 3) continue;
        if (nearest && distance >= least) continue;
        nearest = std::string(candidate);
        least = distance;
    }
    return nearest;
}

std::string suggest_name(std::string_view name, std::span<const std::string_view> valid) {
    if (const auto nearest = nearest_name(name, valid)) return "did you mean '" + *nearest + "'?";
    std::string text = "use one of ";
    for (std::size_t i = 0; i < valid.size(); ++i) {
        if (i > 0) text += ", ";
        text += valid[i];
    }
    return text;
}

}  // namespace loam::lab_data
