// The few HDF5 calls that the store needs, with ownership and errors in the C++ manner. Every function throws
// std::runtime_error naming the object when HDF5 fails or an object is not of the expected kind or shape.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace loam::experiments::hdf5 {

/// All use of HDF5 happens while one of these lives: they exclude each other, since Debian's library is not
/// thread-safe, and HDF5's own printing of errors is off meanwhile.
class Session {
  public:
    Session();
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

  private:
    std::unique_lock<std::mutex> lock_;
    H5E_auto2_t print_ = nullptr;
    void* print_data_ = nullptr;
};

/// Owns an identifier of any kind (file, dataset, type, ...) and gives it back at the end.
class Id {
  public:
    Id(hid_t id, std::string_view name);
    ~Id();
    Id(Id&& other) noexcept;
    Id& operator=(Id&&) = delete;
    operator hid_t() const { return id_; }

  private:
    hid_t id_;
};

using Shape = std::vector<hsize_t>;  // [] one value, [n] a list, [n, d] a table, row by row

/// A new file in memory, which keeps no times.
Id create_file_in_memory();
/// Its bytes.
std::string image_of(hid_t file);
/// The file that has these bytes, read-only.
Id open_image(std::string_view bytes);

Id create_group(hid_t place, const std::string& name);
Id open_object(hid_t place, const std::string& name);

/// Writing makes the dataset; the number of values must be that of the shape. Numbers are stored
/// little-endian, texts in UTF-8 of fixed length, padded with zeros. Number: double, std::uint64_t,
/// std::uint32_t.
template <typename Number>
void write_numbers(hid_t place, const std::string& name, const Shape& shape,
                   const std::vector<Number>& values);
void write_texts(hid_t place, const std::string& name, const std::vector<std::string>& values);

template <typename Number>
std::vector<Number> read_numbers(hid_t place, const std::string& name, const Shape& shape);
std::vector<std::string> read_texts(hid_t place, const std::string& name, hsize_t size);

/// Of a dataset.
Shape shape_of(hid_t place, const std::string& name);

/// Attributes of `object`, likewise. A single text or number has the shape [].
template <typename Number>
void write_number_attribute(hid_t object, const std::string& name, const Shape& shape,
                            const std::vector<Number>& values);
void write_text_attribute(hid_t object, const std::string& name, const Shape& shape,
                          const std::vector<std::string>& values);

template <typename Number>
std::vector<Number> read_number_attribute(hid_t object, const std::string& name, const Shape& shape);
std::vector<std::string> read_text_attribute(hid_t object, const std::string& name, const Shape& shape);

/// By rising name.
std::vector<std::string> attribute_names(hid_t object);

}  // namespace loam::experiments::hdf5
