#include "lab_data/csv_table.hpp"

#include <csv.h>

#include <algorithm>
#include <array>
#include <memory>
#include <new>
#include <set>
#include <string_view>

#include "lab_data/number.hpp"
#include "lab_data/text_file.hpp"

namespace loam::lab_data {
namespace {

constexpr std::size_t largest_csv = 16u << 20;
constexpr std::size_t most_columns = 1000;  // each is compared with every known name

/// What libcsv's callbacks fill: rows, and the line at which the row in work started.
struct RowsRead {
    std::vector<CsvRow> rows;
    CsvRow row;
};

void on_cell(void* text, std::size_t length, void* data) {
    static_cast<RowsRead*>(data)->row.cells.emplace_back(static_cast<const char*>(text), length);
}

void on_row(int, void* data) {
    auto& rows = *static_cast<RowsRead*>(data);
    const bool blank = std::ranges::all_of(rows.row.cells, [](const auto& cell) { return cell.empty(); });
    if (!blank) rows.rows.push_back(std::move(rows.row));
    rows.row = {};
}

/// Takes the first line off `text`; the line comes without its end ("\n", "\r\n" or "\r").
std::string_view next_line(std::string_view& text) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end);
    text.remove_prefix(text.starts_with("\r\n") ? 2 : std::min<std::size_t>(1, text.size()));
    return line;
}

/// The separator that the header has most of. A line without any is a title, and the next ones decide.
char separator_of(std::string_view header, std::string_view below) {
    constexpr std::array<char, 3> separators{',', ';', '\t'};
    for (std::string_view line = header;; line = next_line(below)) {
        std::array<int, 3> counts{};
        bool quoted = false;
        for (const char c : line) {
            if (c == '"') quoted = !quoted;
            for (std::size_t i = 0; i < separators.size() && !quoted; ++i) counts[i] += c == separators[i];
        }
        const auto most = std::ranges::max_element(counts);
        if (*most > 0) return separators[static_cast<std::size_t>(most - counts.begin())];
        if (below.empty()) return separators.front();
    }
}

/// A tab may be the separator, so that it is no white space here.
std::string_view without_spaces(std::string_view text) {
    const std::size_t first = std::min(text.find_first_not_of(' '), text.size());
    return text.substr(first, text.find_last_not_of(' ') + 1 - first);
}

/// Columns that a header names: empty cells at its end are none.
std::size_t count_names(const CsvRow& header) {
    std::size_t count = header.cells.size();
    while (count > 0 && trimmed(header.cells[count - 1]).empty()) --count;
    return count;
}

/// Cells of a line; empty ones beyond `columns` do not count.
std::size_t count_cells(std::string_view line, char separator, std::size_t columns) {
    std::size_t cells = 1;
    bool quoted = false;
    for (const char c : line) {
        if (c == '"') quoted = !quoted;
        if (c == separator && !quoted) ++cells;
    }
    for (line = without_spaces(line); cells > columns && line.ends_with(separator); --cells)
        line = without_spaces(line.substr(0, line.size() - 1));
    return cells;
}

/// Above the header every line that starts with '#' is a comment. Below it, one with a cell for each column
/// is a row: spreadsheets write "#DIV/0!" and "#N/A" into cells, and samples are called "#1".
bool is_comment(std::string_view line, char separator, const std::vector<CsvRow>& rows) {
    if (!trimmed(line).starts_with('#')) return false;
    if (rows.empty()) return true;
    const std::size_t columns = count_names(rows.front());
    return count_cells(line, separator, columns) != columns;
}

/// Feeds libcsv line by line, which is how each row gets its line in the file.
std::optional<std::vector<CsvRow>> split_rows(std::string_view text, const std::string& file,
                                              Faults& faults) {
    csv_parser parser;
    if (csv_init(&parser, CSV_STRICT | CSV_STRICT_FINI) != 0) throw std::bad_alloc();
    const std::unique_ptr<csv_parser, decltype(&csv_free)> owner(&parser, csv_free);
    char separator = ',';
    RowsRead rows;
    for (int line_number = 1; !text.empty(); ++line_number) {
        const std::string_view line = next_line(text);
        const bool row_begins = parser.pstate == 0;  // else a quoted cell goes on
        if (row_begins) {
            if (is_comment(line, separator, rows.rows) || trimmed(line).empty()) continue;
            if (rows.rows.empty()) {  // the header
                separator = separator_of(line, text);
                csv_set_delim(&parser, static_cast<unsigned char>(separator));
            }
            rows.row.line = line_number;
        }
        std::string fed(line);
        fed += '\n';
        if (csv_parse(&parser, fed.data(), fed.size(), on_cell, on_row, &rows) == fed.size()) continue;
        faults.error(
            {.file = file,
             .line = rows.row.line,
             .constraint = "has a quotation mark inside a cell, or one that is never closed",
             .remedy =
                 "enclose the whole cell in quotes and double the quotes inside it, or leave them out"});
        return std::nullopt;
    }
    if (csv_fini(&parser, on_cell, on_row, &rows) != 0) {
        faults.error({.file = file,
                      .line = rows.row.line,
                      .constraint = "has a cell whose quotation mark is never closed",
                      .remedy = "close it or leave it out"});
        return std::nullopt;
    }
    return std::move(rows.rows);
}

bool header_is_sound(const CsvTable& table, Faults& faults) {
    if (table.header.size() > most_columns) {
        faults.error({.file = table.file,
                      .line = table.header_line,
                      .constraint = "has " + std::to_string(table.header.size()) + " columns; the most is " +
                                    std::to_string(most_columns),
                      .remedy = "put readings into rows and quantities into columns"});
        return false;
    }
    if (std::ranges::all_of(table.header, [](const auto& name) { return parse_number(name).has_value(); })) {
        faults.error({.file = table.file,
                      .line = table.header_line,
                      .value = table.header.front(),
                      .constraint = "stands where the columns' names should be",
                      .remedy =
                          "begin the file with a row of names such as axial_stress_kPa,axial_strain, not "
                          "starting with '#'"});
        return false;
    }
    std::set<std::string_view> seen;
    for (const std::string& name : table.header) {
        if (name.empty() || seen.insert(name).second) continue;
        faults.error({.file = table.file,
                      .line = table.header_line,
                      .column = name,
                      .constraint = "is there twice",
                      .remedy = "remove or rename one of them"});
        return false;
    }
    return true;
}

bool has_number(const CsvRow& row) {
    return std::ranges::any_of(row.cells, [](const auto& cell) { return parse_number(cell).has_value(); });
}

/// Whether the first lines are a title, which is shorter than the table under it: a cell alone, or a few
/// above a row of names with numbers below. Reports them.
bool begins_with_title(const CsvTable& table, Faults& faults) {
    const std::size_t columns = table.rows.back().cells.size(), titled = table.header.size();
    const auto is_whole = [&](const CsvRow& row) { return row.cells.size() == columns; };
    const auto is_title = [&](const CsvRow& row) { return count_names(row) <= titled; };
    const auto first = std::ranges::find_if(table.rows, is_whole);
    if (is_title(*first) || !std::all_of(first, table.rows.end(), is_whole) ||
        !std::all_of(table.rows.begin(), first, is_title))
        return false;
    const bool names_follow = !has_number(*first) && first + 1 != table.rows.end();
    const bool sure = titled == 1 ? names_follow || first == table.rows.begin()
                                  : names_follow && has_number(table.rows.back());
    if (!sure) return false;
    faults.error(
        {.file = table.file,
         .line = table.header_line,
         .value = table.header.front(),
         .constraint =
             "is not a row of column names, as the rows below have " + std::to_string(columns) + " cells",
         .remedy = names_follow ? "remove the lines above the header or begin them with #"
                                : "begin the file with a name for each column; lines above that row must be "
                                  "removed or begin with #"});
    return true;
}

/// Rows to the header's length: surplus empty cells go, anything else is a fault.
bool rows_fit(CsvTable& table, Faults& faults) {
    RepeatedFault ragged(faults, table.file);
    const std::size_t columns = table.header.size();
    for (CsvRow& row : table.rows) {
        while (row.cells.size() > columns && row.cells.back().empty()) row.cells.pop_back();
        if (row.cells.size() == columns) continue;
        const bool longer = row.cells.size() > columns;
        ragged.error(
            {.file = table.file,
             .line = row.line,
             .constraint = "has " + std::to_string(row.cells.size()) + " cells where the header names " +
                           std::to_string(columns) + " columns",
             .remedy = longer ? "remove what is too much; if numbers have a decimal comma, write a point"
                              : "add the missing cells or remove the row"});
    }
    return ragged.count() == 0;
}

}  // namespace

std::optional<CsvTable> read_csv(const std::filesystem::path& path, Faults& faults) {
    const auto text = read_text(path, largest_csv, faults);
    if (!text) return std::nullopt;
    const std::string file = path.string();
    auto rows = split_rows(*text, file, faults);
    if (!rows) return std::nullopt;
    if (rows->size() < 2) {
        faults.error({.file = file,
                      .line = rows->empty() ? 0 : rows->front().line,
                      .constraint = rows->empty() ? "is empty" : "has a header but no readings under it",
                      .remedy = "give a row of column names and a row for each reading"});
        return std::nullopt;
    }
    rows->front().cells.resize(count_names(rows->front()));
    CsvTable table{.file = file,
                   .header_line = rows->front().line,
                   .header = std::move(rows->front().cells),
                   .rows = {}};
    rows->erase(rows->begin());
    table.rows = std::move(*rows);
    for (std::string& name : table.header) name = std::string(trimmed(name));
    if (begins_with_title(table, faults) || !header_is_sound(table, faults) || !rows_fit(table, faults))
        return std::nullopt;
    return table;
}

}  // namespace loam::lab_data
