#include "experiments/store/journal.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "experiments/output/storage_error.hpp"
#include "experiments/store/bytes.hpp"
#include "experiments/store/crc64.hpp"
#include "experiments/store/header.hpp"

namespace loam::experiments {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view file_magic = "LOAMJRNL"sv;
constexpr std::string_view record_magic =
    "\xf5RUN\r\n\x1a\n"sv;  // no text, and broken by any newline translation
constexpr std::size_t preamble_size = 32;
constexpr std::size_t frame_size = 24;  // of a record, besides its payload

std::string preamble(std::uint64_t fingerprint) {
    ByteWriter writer;
    writer.number(store_format_version);
    writer.number(std::uint32_t{0});
    writer.number(fingerprint);
    const std::string body = std::string(file_magic) + writer.bytes();
    ByteWriter checksum;
    checksum.number(crc64(body));
    return body + checksum.bytes();
}

std::uint64_t number_at(std::string_view bytes, std::size_t position) {
    std::uint64_t value = 0;
    std::memcpy(&value, bytes.data() + position, sizeof value);
    return value;
}

std::string payload_of(const RunRecord& record) {
    ByteWriter writer;
    writer.number(record.spec.index);
    writer.number(record.spec.packing_seed);
    writer.number(record.spec.particles);
    writer.number(static_cast<std::uint8_t>(record.ok));
    writer.text(record.spec.purpose);
    writer.text(record.reason);
    writer.vector(record.spec.parameters);
    writer.vector(record.outputs);
    writer.vector(record.diagnostics);
    return writer.bytes();
}

/// False if the payload is not a record from end to end.
bool parse_payload(std::string_view payload, RunRecord& record) {
    ByteReader reader(payload);
    record.spec.index = reader.number<std::uint64_t>();
    record.spec.packing_seed = reader.number<std::uint64_t>();
    record.spec.particles = reader.number<std::uint32_t>();
    record.ok = reader.number<std::uint8_t>() != 0;
    record.spec.purpose = reader.text();
    record.reason = reader.text();
    record.spec.parameters = reader.vector();
    record.outputs = reader.vector();
    record.diagnostics = reader.vector();
    return reader.complete();
}

/// The size of the whole record that begins the bytes; 0 if none does.
std::size_t whole_record(std::string_view bytes, std::uint64_t fingerprint, RunRecord& record) {
    if (bytes.size() < frame_size || !bytes.starts_with(record_magic)) return 0;
    const std::uint64_t length = number_at(bytes, record_magic.size());
    if (length > bytes.size() - frame_size) return 0;
    const std::string_view checked = bytes.substr(record_magic.size(), sizeof length + length);
    if (crc64(checked, fingerprint) != number_at(bytes, record_magic.size() + checked.size())) return 0;
    return parse_payload(checked.substr(sizeof length), record) ? frame_size + length : 0;
}

}  // namespace

JournalContents parse_journal(std::string_view bytes, std::uint64_t fingerprint) {
    JournalContents contents;
    // The preamble tells a journal of another campaign from a damaged one. Were it damaged itself, the
    // records still prove by their checksums whose they are.
    const bool whole_preamble =
        bytes.size() >= preamble_size && bytes.starts_with(file_magic) &&
        crc64(bytes.substr(0, preamble_size - 8)) == number_at(bytes, preamble_size - 8);
    if (whole_preamble && bytes.substr(0, preamble_size) != preamble(fingerprint)) {
        contents.foreign = true;
        return contents;
    }
    std::size_t position = whole_preamble ? preamble_size : 0;
    while (position < bytes.size()) {
        RunRecord record;
        const std::size_t size = whole_record(bytes.substr(position), fingerprint, record);
        if (size > 0) {
            contents.records.push_back(std::move(record));
            position += size;
            continue;
        }
        const std::size_t next = std::min(bytes.find(record_magic, position + 1), bytes.size());
        contents.damaged_bytes += next - position;
        position = next;
    }
    return contents;
}

std::string journal_record(const RunRecord& record, std::uint64_t fingerprint) {
    const std::string payload = payload_of(record);
    ByteWriter checked;
    checked.text(payload);
    ByteWriter checksum;
    checksum.number(crc64(checked.bytes(), fingerprint));
    return std::string(record_magic) + checked.bytes() + checksum.bytes();
}

Journal::Journal(std::filesystem::path path, std::uint64_t fingerprint)
    : path_(std::move(path)), fingerprint_(fingerprint) {}

void Journal::create() {
    FileDescriptor file = open_file(path_, O_WRONLY | O_CREAT | O_TRUNC | O_APPEND);
    if (!file) throw_write_error(path_, errno);
    const std::string start = preamble(fingerprint_);
    if (const int error = write_all(file.get(), start)) {
        ::unlink(path_.c_str());
        throw_write_error(path_, error);
    }
    sync_folder(path_.parent_path());
    file_ = std::move(file);
    size_ = static_cast<std::int64_t>(start.size());
}

void Journal::append(const RunRecord& record) {
    if (!file_) create();
    const std::string bytes = journal_record(record, fingerprint_);
    int error = write_all(file_.get(), bytes);
    if (error == 0 && ::fdatasync(file_.get()) != 0) error = errno;
    if (error != 0) {
        // Should this fail too, the tail is torn and will be left out at the next reading.
        if (::ftruncate(file_.get(), size_) != 0) size_ = ::lseek(file_.get(), 0, SEEK_END);
        throw_write_error(path_, error);
    }
    size_ += static_cast<std::int64_t>(bytes.size());
}

void Journal::remove() {
    file_ = FileDescriptor();
    if (::unlink(path_.c_str()) != 0 && errno != ENOENT) throw_write_error(path_, errno);
    sync_folder(path_.parent_path());
}

}  // namespace loam::experiments
