// A CSV file as rows of text cells, each with its line, before any cell has a meaning.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lab_data/faults.hpp"

namespace loam::lab_data {

struct CsvRow {
    int line = 0;  // where it starts in the file, from 1
    std::vector<std::string> cells;
};

struct CsvTable {
    std::string file;  // for messages
    int header_line = 0;
    std::vector<std::string> header;
    std::vector<CsvRow> rows;  // at least one, each with header.size() cells

    /// Where a fault of cell (row, column) is.
    Fault at(std::size_t row, std::size_t column) const {
        return {
            .file = file, .line = rows[row].line, .column = header[column], .value = rows[row].cells[column]};
    }
};

/// Reads a table whose first row names the columns (RFC 4180, with leniency where no meaning can be lost).
/// Separators: comma, semicolon or tab, whichever the header has most of. Blank rows, empty cells beyond the
/// header and any line ends are accepted. A line that starts with '#' is a comment, unless it stands below
/// the header and has a cell for each column. At most 16 MiB and 1000 columns.
/// Reports and gives nothing for: faults of read_text(), an empty file, a title above the header, a header
/// without rows or of numbers, a column name given twice, a row of another length than the header, quotes
/// that do not close.
std::optional<CsvTable> read_csv(const std::filesystem::path& path, Faults& faults);

}  // namespace loam::lab_data
