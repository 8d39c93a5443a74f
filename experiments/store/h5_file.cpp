#include "experiments/store/h5_file.hpp"

#include <fmt/format.h>

#include <charconv>
#include <limits>
#include <stdexcept>

#include "experiments/store/crc64.hpp"
#include "experiments/store/hdf5.hpp"
#include "lab_data/user_error.hpp"

namespace loam::experiments {
namespace {

using hdf5::Shape;

constexpr std::string_view format_name = "loam ensemble";
constexpr std::string_view title = "loam ensemble, format ";
constexpr std::size_t user_block_size = 512;  // the smallest that HDF5 allows

std::string user_block(std::string_view image) {
    std::string block = fmt::format("{}{}\nHDF5 from byte {} on, crc64-xz {:016x}\n", title,
                                    store_format_version, user_block_size, crc64(image));
    block.resize(user_block_size, '\0');
    return block;
}

/// One list from one member of each record or column.
template <typename Items, typename Member>
auto list_of(const Items& items, Member member) {
    std::vector<std::decay_t<decltype(member(*items.begin()))>> values;
    values.reserve(items.size());
    for (const auto& item : items) values.push_back(member(item));
    return values;
}

/// Row by row; a vector that is empty (a failed run has no outputs) becomes a row of NaN.
template <typename Member>
std::vector<double> table_of(const std::vector<RunRecord>& records, std::size_t columns, Member member) {
    std::vector<double> values;
    values.reserve(records.size() * columns);
    for (const RunRecord& record : records) {
        const Eigen::VectorXd& row = member(record);
        if (row.size() == 0)
            values.insert(values.end(), columns, std::numeric_limits<double>::quiet_NaN());
        else
            values.insert(values.end(), row.begin(), row.end());
    }
    return values;
}

void write_header(hid_t file, const EnsembleHeader& header) {
    hdf5::write_text_attribute(file, "format", {}, {std::string(format_name)});
    hdf5::write_number_attribute<std::uint32_t>(file, "format_version", {}, {store_format_version});
    hdf5::write_number_attribute<std::uint64_t>(file, "campaign_seed", {}, {header.campaign_seed});
    for (const auto& [name, value] : header.attributes) hdf5::write_text_attribute(file, name, {}, {value});

    const hdf5::Id group = hdf5::create_group(file, "output_columns");
    const std::vector<OutputColumn>& outputs = header.outputs;
    hdf5::write_texts(group, "file", list_of(outputs, [](const auto& c) { return c.file; }));
    hdf5::write_texts(group, "channel", list_of(outputs, [](const auto& c) { return c.channel; }));
    hdf5::write_texts(group, "unit", list_of(outputs, [](const auto& c) { return c.unit; }));
    hdf5::write_texts(group, "x_channel", list_of(outputs, [](const auto& c) { return c.x_channel; }));
    hdf5::write_texts(group, "x_unit", list_of(outputs, [](const auto& c) { return c.x_unit; }));
    hdf5::write_numbers(group, "x", {outputs.size()}, list_of(outputs, [](const auto& c) { return c.x; }));
}

void write_records(hid_t file, const EnsembleContents& contents) {
    const auto& [header, records] = contents;
    const hsize_t n = records.size();
    const Shape list{n};
    hdf5::write_numbers(file, "index", list, list_of(records, [](const auto& r) { return r.spec.index; }));
    hdf5::write_texts(file, "purpose", list_of(records, [](const auto& r) { return r.spec.purpose; }));
    hdf5::write_numbers(file, "packing_seed", list,
                        list_of(records, [](const auto& r) { return r.spec.packing_seed; }));
    hdf5::write_numbers(file, "particles", list,
                        list_of(records, [](const auto& r) { return r.spec.particles; }));
    hdf5::write_texts(file, "status",
                      list_of(records, [](const auto& r) { return std::string(r.ok ? "ok" : "failed"); }));
    hdf5::write_texts(file, "reason", list_of(records, [](const auto& r) { return r.reason; }));

    const std::size_t d = header.parameters.size();
    hdf5::write_numbers(file, "parameters", {n, d},
                        table_of(
                            records, d, [](const auto& r) -> const auto& { return r.spec.parameters; }));
    const hdf5::Id parameters = hdf5::open_object(file, "parameters");
    hdf5::write_text_attribute(parameters, "name", {d},
                               list_of(header.parameters, [](const auto& c) { return c.name; }));
    hdf5::write_text_attribute(parameters, "unit", {d},
                               list_of(header.parameters, [](const auto& c) { return c.unit; }));
    hdf5::write_number_attribute(parameters, "lower", {d},
                                 list_of(header.parameters, [](const auto& c) { return c.lower; }));
    hdf5::write_number_attribute(parameters, "upper", {d},
                                 list_of(header.parameters, [](const auto& c) { return c.upper; }));

    const std::size_t m = header.outputs.size();
    hdf5::write_numbers(file, "outputs", {n, m},
                        table_of(
                            records, m, [](const auto& r) -> const auto& { return r.outputs; }));

    const std::size_t k = header.diagnostics.size();
    hdf5::write_numbers(file, "diagnostics", {n, k},
                        table_of(
                            records, k, [](const auto& r) -> const auto& { return r.diagnostics; }));
    const hdf5::Id diagnostics = hdf5::open_object(file, "diagnostics");
    hdf5::write_text_attribute(diagnostics, "name", {k},
                               list_of(header.diagnostics, [](const auto& c) { return c.name; }));
    hdf5::write_text_attribute(diagnostics, "unit", {k},
                               list_of(header.diagnostics, [](const auto& c) { return c.unit; }));
}

EnsembleHeader read_header(hid_t file) {
    EnsembleHeader header;
    header.campaign_seed = hdf5::read_number_attribute<std::uint64_t>(file, "campaign_seed", {}).front();
    for (const std::string& name : hdf5::attribute_names(file)) {
        if (name == "format" || name == "format_version" || name == "campaign_seed") continue;
        header.attributes[name] = hdf5::read_text_attribute(file, name, {}).front();
    }
    const hsize_t d = hdf5::shape_of(file, "parameters").at(1);
    const hdf5::Id parameters = hdf5::open_object(file, "parameters");
    const auto names = hdf5::read_text_attribute(parameters, "name", {d});
    const auto units = hdf5::read_text_attribute(parameters, "unit", {d});
    const auto lower = hdf5::read_number_attribute<double>(parameters, "lower", {d});
    const auto upper = hdf5::read_number_attribute<double>(parameters, "upper", {d});
    for (std::size_t i = 0; i < d; ++i) header.parameters.push_back({names[i], units[i], lower[i], upper[i]});

    const hsize_t k = hdf5::shape_of(file, "diagnostics").at(1);
    const hdf5::Id diagnostics = hdf5::open_object(file, "diagnostics");
    const auto diagnostic_names = hdf5::read_text_attribute(diagnostics, "name", {k});
    const auto diagnostic_units = hdf5::read_text_attribute(diagnostics, "unit", {k});
    for (std::size_t i = 0; i < k; ++i)
        header.diagnostics.push_back({diagnostic_names[i], diagnostic_units[i]});

    const hsize_t m = hdf5::shape_of(file, "outputs").at(1);
    const hdf5::Id group = hdf5::open_object(file, "output_columns");
    const auto files = hdf5::read_texts(group, "file", m);
    const auto channels = hdf5::read_texts(group, "channel", m);
    const auto output_units = hdf5::read_texts(group, "unit", m);
    const auto x_channels = hdf5::read_texts(group, "x_channel", m);
    const auto x_units = hdf5::read_texts(group, "x_unit", m);
    const auto x = hdf5::read_numbers<double>(group, "x", {m});
    for (std::size_t i = 0; i < m; ++i)
        header.outputs.push_back({files[i], channels[i], output_units[i], x_channels[i], x_units[i], x[i]});
    return header;
}

Eigen::VectorXd row_of(const std::vector<double>& table, std::size_t row, std::size_t columns) {
    return Eigen::Map<const Eigen::VectorXd>(table.data() + row * columns,
                                             static_cast<Eigen::Index>(columns));
}

std::vector<RunRecord> read_records(hid_t file, const EnsembleHeader& header) {
    const hsize_t n = hdf5::shape_of(file, "index").at(0);
    const std::size_t d = header.parameters.size();
    const std::size_t m = header.outputs.size();
    const std::size_t k = header.diagnostics.size();
    const auto index = hdf5::read_numbers<std::uint64_t>(file, "index", {n});
    const auto purpose = hdf5::read_texts(file, "purpose", n);
    const auto packing_seed = hdf5::read_numbers<std::uint64_t>(file, "packing_seed", {n});
    const auto particles = hdf5::read_numbers<std::uint32_t>(file, "particles", {n});
    const auto status = hdf5::read_texts(file, "status", n);
    const auto reason = hdf5::read_texts(file, "reason", n);
    const auto parameters = hdf5::read_numbers<double>(file, "parameters", {n, d});
    const auto outputs = hdf5::read_numbers<double>(file, "outputs", {n, m});
    const auto diagnostics = hdf5::read_numbers<double>(file, "diagnostics", {n, k});

    std::vector<RunRecord> records(n);
    for (std::size_t i = 0; i < n; ++i) {
        RunRecord& record = records[i];
        record.spec = {index[i], purpose[i], row_of(parameters, i, d), packing_seed[i], particles[i]};
        record.ok = status[i] == "ok";
        record.reason = reason[i];
        if (record.ok) record.outputs = row_of(outputs, i, m);
        record.diagnostics = row_of(diagnostics, i, k);
    }
    return records;
}

[[noreturn]] void refuse(const std::filesystem::path& path, std::string constraint, std::string remedy) {
    throw lab_data::UserError(
        {.file = path.string(), .constraint = std::move(constraint), .remedy = std::move(remedy)});
}

/// Checks title, version and checksum, so that HDF5 is only given what this program has written.
std::string_view checked_image(std::string_view bytes, const std::filesystem::path& path) {
    const std::string remedy =
        "put back a copy, or delete it to run the ensemble again, or choose another folder with --out";
    if (!bytes.starts_with(title) || bytes.size() < user_block_size)
        refuse(path, "is not an ensemble of this program, or its beginning is damaged", remedy);
    std::uint32_t version = 0;
    std::from_chars(bytes.data() + title.size(), bytes.data() + user_block_size, version);
    if (version != store_format_version)
        refuse(
            path,
            fmt::format("has the format of another version of this program ({}, this one's is {})", version,
                        store_format_version),
            "use that version, or choose another folder with --out, or delete it to run the ensemble again");
    const std::string_view image = bytes.substr(user_block_size);
    if (bytes.substr(0, user_block_size) != user_block(image))
        refuse(path, "is damaged: cut short, or changed since it was written (its checksum does not match)",
               remedy);
    return image;
}

}  // namespace

std::string encode_ensemble(const EnsembleContents& contents) {
    const hdf5::Session session;
    const hdf5::Id file = hdf5::create_file_in_memory();
    write_header(file, contents.header);
    write_records(file, contents);
    const std::string image = hdf5::image_of(file);
    return user_block(image) + image;
}

EnsembleContents decode_ensemble(std::string_view bytes, const std::filesystem::path& path) {
    const std::string_view image = checked_image(bytes, path);
    const hdf5::Session session;
    try {
        const hdf5::Id file = hdf5::open_image(image);
        EnsembleContents contents;
        contents.header = read_header(file);
        contents.records = read_records(file, contents.header);
        return contents;
    } catch (const std::runtime_error& error) {
        refuse(path, fmt::format("is not an ensemble that this program understands ({})", error.what()),
               "delete it to run the ensemble again, or choose another folder with --out");
    }
}

}  // namespace loam::experiments
