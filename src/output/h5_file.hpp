// One HDF5 file, in the few words the results need. HDF5 itself is seen by h5_file.cpp only.
//
// A process may be killed at any moment and a disk may fill up. The file on disk is always that of the last flush: writing
// goes through a CommitFile, and after a failed write nothing more reaches the disk, not even on closing.
#pragma once

#include "core/types.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace talus {
class CommitFile;
}

namespace talus::h5 {

enum class Type { f32, f64, i32, i64, u8 };

template <class T>
constexpr Type type_of() {
    if constexpr (std::is_same_v<T, float>) return Type::f32;
    if constexpr (std::is_same_v<T, double>) return Type::f64;
    if constexpr (std::is_same_v<T, std::int32_t>) return Type::i32;
    if constexpr (std::is_same_v<T, std::int64_t>) return Type::i64;
    if constexpr (std::is_same_v<T, std::uint8_t>) return Type::u8;
}

using Shape = std::vector<std::int64_t>;

/// Attributes every dataset carries: its unit ("1" for plain numbers, "-" for text) and its shape in words ("blocks x 2").
struct Meaning {
    std::string unit, shape;
};

/// A dataset that grows by rows. Compressed ones must grow by whole chunks, for a compressed chunk that is rewritten can be
/// damaged by a kill; uncompressed ones may grow by any number of rows.
struct Rows {
    Shape row;                  // shape of one row; empty = one number
    std::int64_t chunk = 1024;  // rows per chunk
    bool compressed = false;    // shuffle and gzip 1, which every HDF5 reader knows
};

/// Writing throws OutputError, opening and reading InputError; both name the file and the reason.
class File {
public:
    static File create(const std::string& path);  // replaces what is there
    static File open(const std::string& path);    // to read, also while another process writes it
    static File edit(const std::string& path);    // to go on writing
    File(File&& other) noexcept;
    File& operator=(File&& other) noexcept;
    ~File();

    // Groups and datasets; missing groups of a path are made.
    void make_group(const std::string& path);
    template <class T>
    void write(const std::string& path, std::span<const T> values, const Shape& shape, const Meaning& meaning) {
        write_raw(path, type_of<T>(), values.data(), shape, meaning);
    }
    template <class T>
    void make_rows(const std::string& path, const Rows& rows, const Meaning& meaning) {
        make_rows_raw(path, type_of<T>(), rows, meaning);
    }
    template <class T>
    void append(const std::string& path, std::span<const T> values) {
        append_raw(path, type_of<T>(), values.data(), static_cast<std::int64_t>(values.size()));
    }
    void write_text(const std::string& path, const std::string& text);
    void write_texts(const std::string& path, const std::vector<std::string>& texts, const std::string& shape);
    void truncate(const std::string& path, std::int64_t rows);  // keeps at most this many rows

    // Attributes of a group or dataset. Setting one again replaces it, in its place if the new one is not longer.
    void set(const std::string& path, const std::string& name, const std::string& text);
    void set(const std::string& path, const std::string& name, double value);
    void set(const std::string& path, const std::string& name, std::int64_t value);
    void set(const std::string& path, const std::string& name, std::span<const double> values);
    void set(const std::string& path, const std::string& name, std::span<const std::int64_t> values);
    void set(const std::string& path, const std::string& name, std::span<const std::string> texts);

    /// Everything written so far is in the file when this returns. Only then.
    void flush();

    // Reading.
    bool exists(const std::string& path) const;
    Shape shape(const std::string& path) const;
    std::int64_t rows(const std::string& path) const { return shape(path).at(0); }
    template <class T>
    std::vector<T> read(const std::string& path) const {
        std::vector<T> values(static_cast<std::size_t>(size(path)));
        read_raw(path, type_of<T>(), values.data());
        return values;
    }
    /// Rows [first, first + count).
    template <class T>
    std::vector<T> read_rows(const std::string& path, std::int64_t first, std::int64_t count) const {
        std::vector<T> values(static_cast<std::size_t>(rows(path) == 0 ? 0 : size(path) / rows(path) * count));
        read_rows_raw(path, type_of<T>(), first, count, values.data());
        return values;
    }
    std::string type_name(const std::string& path) const;  // f32, f64, i32, i64, u8, text
    std::string read_text(const std::string& path) const;
    std::vector<std::string> read_texts(const std::string& path) const;
    bool has_attribute(const std::string& path, const std::string& name) const;
    std::string text(const std::string& path, const std::string& name) const;
    std::vector<std::string> texts(const std::string& path, const std::string& name) const;
    std::vector<double> numbers(const std::string& path, const std::string& name) const;
    std::int64_t integer(const std::string& path, const std::string& name) const;  // below 2^53
    std::vector<std::string> attributes(const std::string& path) const;            // names, sorted
    bool is_text_attribute(const std::string& path, const std::string& name) const;
    std::vector<std::string> children(const std::string& group) const;  // names, sorted
    std::vector<std::string> datasets() const;                          // full paths of the whole file, sorted

    const std::string& path() const { return path_; }

private:
    File(std::string path, std::int64_t id, bool writes) : path_(std::move(path)), id_(id), writes_(writes) {}
    void write_raw(const std::string& path, Type type, const void* values, const Shape& shape, const Meaning& meaning);
    void make_rows_raw(const std::string& path, Type type, const Rows& rows, const Meaning& meaning);
    void write_packed(const std::string& path, std::span<const std::string> texts, const Shape& shape,
                      const Meaning& meaning);
    void describe(const std::string& path, const Meaning& meaning);
    void set_packed(const std::string& path, const std::string& name, std::span<const std::string> texts,
                    const Shape& shape);
    void append_raw(const std::string& path, Type type, const void* values, std::int64_t count);
    void set_raw(const std::string& path, const std::string& name, Type type, const void* values, std::int64_t count);
    void read_raw(const std::string& path, Type type, void* values) const;
    void read_rows_raw(const std::string& path, Type type, std::int64_t first, std::int64_t count, void* values) const;
    std::int64_t size(const std::string& path) const;
    [[noreturn]] void fail_writing(const std::string& what);
    [[noreturn]] void fail_reading(const std::string& what) const;
    CommitFile* commits() const;
    void close();

    std::string path_;
    std::int64_t id_ = -1;
    bool writes_ = false;
};

}  // namespace talus::h5
