#include "experiments/store/hdf5.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace loam::experiments::hdf5 {
namespace {

[[noreturn]] void fail(std::string_view name) {
    throw std::runtime_error("HDF5 failed at '" + std::string(name) + "'");
}

void check(herr_t status, std::string_view name) {
    if (status < 0) fail(name);
}

std::mutex& library_mutex() {
    static std::mutex mutex;
    return mutex;
}

/// The type in the file (fixed, little-endian) and in memory.
struct NumberType {
    hid_t stored;
    hid_t native;
};

template <typename Number>
NumberType number_type();
template <>
NumberType number_type<double>() {
    return {H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE};
}
template <>
NumberType number_type<std::uint64_t>() {
    return {H5T_STD_U64LE, H5T_NATIVE_UINT64};
}
template <>
NumberType number_type<std::uint32_t>() {
    return {H5T_STD_U32LE, H5T_NATIVE_UINT32};
}

hsize_t count(const Shape& shape) {
    return std::accumulate(shape.begin(), shape.end(), hsize_t{1}, std::multiplies<>());
}

Id make_space(const Shape& shape, const std::string& name) {
    if (shape.empty()) return {H5Screate(H5S_SCALAR), name};
    return {H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), name};
}

Shape shape_of_space(hid_t space, const std::string& name) {
    const int rank = H5Sget_simple_extent_ndims(space);
    if (rank < 0) fail(name);
    Shape shape(static_cast<std::size_t>(rank));
    if (rank > 0 && H5Sget_simple_extent_dims(space, shape.data(), nullptr) < 0) fail(name);
    return shape;
}

Id text_type(std::size_t length, const std::string& name) {
    Id type(H5Tcopy(H5T_C_S1), name);
    check(H5Tset_size(type, std::max<std::size_t>(1, length)), name);
    check(H5Tset_strpad(type, H5T_STR_NULLPAD), name);
    check(H5Tset_cset(type, H5T_CSET_UTF8), name);
    return type;
}

/// Texts as HDF5 wants them: one after the other, each padded with zeros to the longest.
struct PackedTexts {
    std::size_t length = 1;
    std::string bytes;
    explicit PackedTexts(const std::vector<std::string>& values) {
        for (const std::string& value : values) length = std::max(length, value.size());
        for (const std::string& value : values) bytes += value + std::string(length - value.size(), '\0');
    }
};

std::vector<std::string> unpack(const std::string& bytes, std::size_t length) {
    std::vector<std::string> values;
    for (std::size_t start = 0; start < bytes.size(); start += length)
        values.emplace_back(bytes.substr(start, length).c_str());
    return values;
}

/// The length of the fixed-length texts of this type; fails if it is another kind of type.
std::size_t text_length(hid_t type, const std::string& name) {
    const bool fixed_text = H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0;
    if (!fixed_text || H5Tget_size(type) == 0) fail(name);
    return H5Tget_size(type);
}

template <typename Number>
void check_number(hid_t type, const std::string& name) {
    if (H5Tequal(type, number_type<Number>().stored) <= 0) fail(name);
}

void check_shape(hid_t space, const Shape& expected, const std::string& name) {
    if (shape_of_space(space, name) != expected) fail(name);
}

void write_dataset(hid_t place, const std::string& name, const Shape& shape, NumberType type,
                   const void* values) {
    const Id space = make_space(shape, name);
    const Id properties(H5Pcreate(H5P_DATASET_CREATE), name);
    check(H5Pset_obj_track_times(properties, false), name);
    const Id dataset(
        H5Dcreate2(place, name.c_str(), type.stored, space, H5P_DEFAULT, properties, H5P_DEFAULT), name);
    if (count(shape) > 0) check(H5Dwrite(dataset, type.native, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), name);
}

void write_attribute(hid_t object, const std::string& name, const Shape& shape, NumberType type,
                     const void* values) {
    const Id space = make_space(shape, name);
    const Id attribute(H5Acreate2(object, name.c_str(), type.stored, space, H5P_DEFAULT, H5P_DEFAULT), name);
    if (count(shape) > 0) check(H5Awrite(attribute, type.native, values), name);
}

}  // namespace

Session::Session() : lock_(library_mutex()) {
    H5Eget_auto2(H5E_DEFAULT, &print_, &print_data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Session::~Session() {
    H5Eset_auto2(H5E_DEFAULT, print_, print_data_);
}

Id::Id(hid_t id, std::string_view name) : id_(id) {
    if (id < 0) fail(name);
}

Id::~Id() {
    if (id_ >= 0) H5Idec_ref(id_);
}

Id::Id(Id&& other) noexcept : id_(std::exchange(other.id_, -1)) {}

Id create_file_in_memory() {
    const Id access(H5Pcreate(H5P_FILE_ACCESS), "file access");
    constexpr std::size_t growth = 1 << 20;
    check(H5Pset_fapl_core(access, growth, false), "file in memory");
    const Id creation(H5Pcreate(H5P_FILE_CREATE), "file creation");
    check(H5Pset_obj_track_times(creation, false), "file creation");
    return {H5Fcreate("ensemble", H5F_ACC_TRUNC, creation, access), "file in memory"};
}

std::string image_of(hid_t file) {
    check(H5Fflush(file, H5F_SCOPE_GLOBAL), "file image");
    const ssize_t size = H5Fget_file_image(file, nullptr, 0);
    if (size < 0) fail("file image");
    std::string bytes(static_cast<std::size_t>(size), '\0');
    if (H5Fget_file_image(file, bytes.data(), bytes.size()) != size) fail("file image");
    return bytes;
}

Id open_image(std::string_view bytes) {
    const Id access(H5Pcreate(H5P_FILE_ACCESS), "file access");
    constexpr std::size_t growth = 1 << 20;
    check(H5Pset_fapl_core(access, growth, false), "file in memory");
    // HDF5 copies the bytes and does not change them, whatever its signature says.
    check(H5Pset_file_image(access, const_cast<char*>(bytes.data()), bytes.size()), "file image");
    return {H5Fopen("ensemble", H5F_ACC_RDONLY, access), "file image"};
}

Id create_group(hid_t place, const std::string& name) {
    const Id properties(H5Pcreate(H5P_GROUP_CREATE), name);
    check(H5Pset_obj_track_times(properties, false), name);
    return {H5Gcreate2(place, name.c_str(), H5P_DEFAULT, properties, H5P_DEFAULT), name};
}

Id open_object(hid_t place, const std::string& name) {
    return {H5Oopen(place, name.c_str(), H5P_DEFAULT), name};
}

template <typename Number>
void write_numbers(hid_t place, const std::string& name, const Shape& shape,
                   const std::vector<Number>& values) {
    if (values.size() != count(shape)) fail(name);
    write_dataset(place, name, shape, number_type<Number>(), values.data());
}

void write_texts(hid_t place, const std::string& name, const std::vector<std::string>& values) {
    const PackedTexts packed(values);
    const Id type = text_type(packed.length, name);
    write_dataset(place, name, {values.size()}, {type, type}, packed.bytes.data());
}

template <typename Number>
std::vector<Number> read_numbers(hid_t place, const std::string& name, const Shape& shape) {
    const Id dataset(H5Dopen2(place, name.c_str(), H5P_DEFAULT), name);
    check_number<Number>(Id(H5Dget_type(dataset), name), name);
    check_shape(Id(H5Dget_space(dataset), name), shape, name);
    std::vector<Number> values(count(shape));
    if (!values.empty())
        check(H5Dread(dataset, number_type<Number>().native, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
              name);
    return values;
}

std::vector<std::string> read_texts(hid_t place, const std::string& name, hsize_t size) {
    const Id dataset(H5Dopen2(place, name.c_str(), H5P_DEFAULT), name);
    const Id type(H5Dget_type(dataset), name);
    const std::size_t length = text_length(type, name);
    check_shape(Id(H5Dget_space(dataset), name), {size}, name);
    std::string bytes(length * size, '\0');
    if (size > 0) check(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()), name);
    return unpack(bytes, length);
}

Shape shape_of(hid_t place, const std::string& name) {
    const Id dataset(H5Dopen2(place, name.c_str(), H5P_DEFAULT), name);
    return shape_of_space(Id(H5Dget_space(dataset), name), name);
}

template <typename Number>
void write_number_attribute(hid_t object, const std::string& name, const Shape& shape,
                            const std::vector<Number>& values) {
    if (values.size() != count(shape)) fail(name);
    write_attribute(object, name, shape, number_type<Number>(), values.data());
}

void write_text_attribute(hid_t object, const std::string& name, const Shape& shape,
                          const std::vector<std::string>& values) {
    if (values.size() != count(shape)) fail(name);
    const PackedTexts packed(values);
    const Id type = text_type(packed.length, name);
    write_attribute(object, name, shape, {type, type}, packed.bytes.data());
}

template <typename Number>
std::vector<Number> read_number_attribute(hid_t object, const std::string& name, const Shape& shape) {
    const Id attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), name);
    check_number<Number>(Id(H5Aget_type(attribute), name), name);
    check_shape(Id(H5Aget_space(attribute), name), shape, name);
    std::vector<Number> values(count(shape));
    if (!values.empty()) check(H5Aread(attribute, number_type<Number>().native, values.data()), name);
    return values;
}

std::vector<std::string> read_text_attribute(hid_t object, const std::string& name, const Shape& shape) {
    const Id attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), name);
    const Id type(H5Aget_type(attribute), name);
    const std::size_t length = text_length(type, name);
    check_shape(Id(H5Aget_space(attribute), name), shape, name);
    std::string bytes(length * count(shape), '\0');
    if (!bytes.empty()) check(H5Aread(attribute, type, bytes.data()), name);
    return unpack(bytes, length);
}

std::vector<std::string> attribute_names(hid_t object) {
    std::vector<std::string> names;
    const auto collect = [](hid_t, const char* name, const H5A_info_t*, void* list) -> herr_t {
        static_cast<std::vector<std::string>*>(list)->emplace_back(name);
        return 0;
    };
    hsize_t position = 0;
    check(H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, &position, collect, &names), "attributes");
    std::sort(names.begin(), names.end());
    return names;
}

template void write_numbers(hid_t, const std::string&, const Shape&, const std::vector<double>&);
template void write_numbers(hid_t, const std::string&, const Shape&, const std::vector<std::uint64_t>&);
template void write_numbers(hid_t, const std::string&, const Shape&, const std::vector<std::uint32_t>&);
template std::vector<double> read_numbers(hid_t, const std::string&, const Shape&);
template std::vector<std::uint64_t> read_numbers(hid_t, const std::string&, const Shape&);
template std::vector<std::uint32_t> read_numbers(hid_t, const std::string&, const Shape&);
template void write_number_attribute(hid_t, const std::string&, const Shape&, const std::vector<double>&);
template void write_number_attribute(hid_t, const std::string&, const Shape&,
                                     const std::vector<std::uint64_t>&);
template void write_number_attribute(hid_t, const std::string&, const Shape&,
                                     const std::vector<std::uint32_t>&);
template std::vector<double> read_number_attribute(hid_t, const std::string&, const Shape&);
template std::vector<std::uint64_t> read_number_attribute(hid_t, const std::string&, const Shape&);
template std::vector<std::uint32_t> read_number_attribute(hid_t, const std::string&, const Shape&);

}  // namespace loam::experiments::hdf5
