// Writes the report of the document on standard input (JSON) to standard output: the report writer without a
// run.
#include <iostream>

#include "experiments/report/report.hpp"

int main() {
    nlohmann::json document;
    std::cin >> document;
    std::cout << loam::experiments::report_html(document);
    return std::cout.flush() ? 0 : 1;
}
