// The one exception for mistakes of the program's user: it says where, what, which rule, and what to do about
// it. Every layer that reads input (files, configuration, command line) throws it; the command line answers
// it with exit status 2. Mistakes of the programmer are assertions or std::invalid_argument, never this.
#pragma once

#include <stdexcept>
#include <string>

namespace loam::lab_data {

/// What is wrong. Fields that do not apply stay empty (line 0: none); designated initialisers may leave them
/// out. The text is put together as "file:line: column 'axial_strain': value '12,5' must be a number;
/// write 12.5".
struct Fault {
    std::string file = {};        // as the user would write it
    int line = 0;                 // from 1; 0: none
    std::string column = {};      // CSV column, TOML key, or command-line option ("--particles")
    std::string value = {};       // as written
    std::string constraint = {};  // the rule, as the rest of a sentence: "must be a number", "is missing"
    std::string remedy = {};      // what to do, as a sentence without its full stop: "write 12.5"
    int position = 0;             // in the line, from 1; 0: none
};

class UserError : public std::runtime_error {
  public:
    explicit UserError(Fault fault);

    const Fault& fault() const { return fault_; }
    const std::string& file() const { return fault_.file; }
    int line() const { return fault_.line; }
    const std::string& column() const { return fault_.column; }
    const std::string& value() const { return fault_.value; }
    const std::string& constraint() const { return fault_.constraint; }
    const std::string& remedy() const { return fault_.remedy; }

  private:
    Fault fault_;
};

}  // namespace loam::lab_data
