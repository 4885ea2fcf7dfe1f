#include "output/h5_file.hpp"

#include "core/errors.hpp"
#include "output/commit_file.hpp"

#include <hdf5.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <functional>
#include <numeric>
#include <utility>

namespace talus::h5 {
namespace {

static_assert(sizeof(hid_t) == sizeof(std::int64_t));

/// Closes an id of HDF5 when it goes out of scope.
class Handle {
public:
    Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
    Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
    Handle& operator=(const Handle&) = delete;
    ~Handle() {
        if (id_ >= 0) close_(id_);
    }
    operator hid_t() const { return id_; }
    bool bad() const { return id_ < 0; }

private:
    hid_t id_;
    herr_t (*close_)(hid_t);
};

hid_t in_memory(Type type) {
    switch (type) {
        case Type::f32:
            return H5T_NATIVE_FLOAT;
        case Type::f64:
            return H5T_NATIVE_DOUBLE;
        case Type::i32:
            return H5T_NATIVE_INT32;
        case Type::i64:
            return H5T_NATIVE_INT64;
        case Type::u8:
            return H5T_NATIVE_UINT8;
    }
    return -1;
}

hid_t in_file(Type type) {
    switch (type) {
        case Type::f32:
            return H5T_IEEE_F32LE;
        case Type::f64:
            return H5T_IEEE_F64LE;
        case Type::i32:
            return H5T_STD_I32LE;
        case Type::i64:
            return H5T_STD_I64LE;
        case Type::u8:
            return H5T_STD_U8LE;
    }
    return -1;
}

/// The innermost message of HDF5, or what the system said if it is quoted in it.
std::string reason() {
    std::string text;
    const auto first = [](unsigned, const H5E_error2_t* error, void* out) -> herr_t {
        auto& message = *static_cast<std::string*>(out);
        if (message.empty() && error->desc) message = error->desc;
        return 0;
    };
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, first, &text);
    const std::string key = "error message = '";
    if (const auto at = text.find(key); at != std::string::npos)
        return text.substr(at + key.size(), text.find('\'', at + key.size()) - at - key.size());
    return text.empty() ? "unknown reason" : text;
}

bool is_fixed_text(hid_t type) { return H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) <= 0; }

void be_silent() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

std::int64_t product(const Shape& shape) {
    return std::accumulate(shape.begin(), shape.end(), std::int64_t{1}, std::multiplies<>());
}

std::vector<hsize_t> extents(const Shape& shape) { return {shape.begin(), shape.end()}; }

Handle make_space(const Shape& shape) {
    if (shape.empty()) return {H5Screate(H5S_SCALAR), H5Sclose};
    const auto dims = extents(shape);
    return {H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr), H5Sclose};
}

/// Text is of fixed length, for readers differ in what they make of variable length; a string of no length does not exist.
Handle text_type(std::size_t length) {
    Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type, std::max<std::size_t>(length, 1));
    H5Tset_strpad(type, H5T_STR_NULLPAD);
    return type;
}

Handle with_groups() {
    Handle list(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
    H5Pset_create_intermediate_group(list, 1);
    return list;
}

/// Data go to the disk as they come: what a chunk cache still holds at a kill would be lost, and it costs memory.
Handle without_chunk_cache() {
    Handle list(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
    H5Pset_chunk_cache(list, 1, 0, 1.0);
    return list;
}

// --- The driver through which HDF5 writes: hands its reads and writes to a CommitFile, with the order of commits.

struct Driver {
    H5FD_t base;  // HDF5 sees this part
    CommitFile file;
    haddr_t end;  // of what HDF5 has given out
};

Driver* driver(const H5FD_t* file) { return reinterpret_cast<Driver*>(const_cast<H5FD_t*>(file)); }

std::string why_not_opened;

H5FD_t* open_driver(const char* path, unsigned flags, hid_t, haddr_t) {
    const auto how = flags & H5F_ACC_TRUNC ? CommitFile::Open::to_replace : CommitFile::Open::to_change;
    auto* opened = new Driver{{}, {path, how}, 0};
    why_not_opened = opened->file.problem();
    if (why_not_opened.empty()) return &opened->base;
    delete opened;
    return nullptr;
}

herr_t close_driver(H5FD_t* file) {
    delete driver(file);
    return 0;
}

int compare_drivers(const H5FD_t* a, const H5FD_t* b) {
    return driver(a)->file.same_file(driver(b)->file) ? 0 : (a < b ? -1 : 1);
}

herr_t query_driver(const H5FD_t*, unsigned long* features) {
    *features = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_DATA_SIEVE;
    return 0;
}

/// What is pointed to goes before what points to it: data, the end of the file, names, trees from the root down (a node
/// that was split loses entries only after its parent knows the new node), and last the headers with the sizes.
int commit_order(H5FD_mem_t type, const char* bytes, std::size_t count) {
    switch (type) {
        case H5FD_MEM_DRAW:
            return 0;
        case H5FD_MEM_SUPER:
            return 1;
        case H5FD_MEM_OHDR:
            return CommitFile::last_order;
        case H5FD_MEM_BTREE: {
            const bool node = count > 5 && std::memcmp(bytes, "TREE", 4) == 0;  // its level stands in byte 5
            return node ? 300 - static_cast<unsigned char>(bytes[5]) : 400;
        }
        default:
            return 2;
    }
}

herr_t read_driver(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, std::size_t count, void* bytes) {
    return driver(file)->file.read(at, count, bytes) ? 0 : -1;
}

herr_t write_driver(H5FD_t* file, H5FD_mem_t type, hid_t, haddr_t at, std::size_t count, const void* bytes) {
    const int order = commit_order(type, static_cast<const char*>(bytes), count);
    return driver(file)->file.write(at, count, bytes, order) ? 0 : -1;
}

haddr_t get_end(const H5FD_t* file, H5FD_mem_t) { return driver(file)->end; }

herr_t set_end(H5FD_t* file, H5FD_mem_t, haddr_t end) {
    driver(file)->end = end;
    return 0;
}

haddr_t get_size(const H5FD_t* file, H5FD_mem_t) { return driver(file)->file.size(); }

herr_t get_driver(H5FD_t* file, hid_t, void** handle) {
    *handle = driver(file);
    return 0;
}

hid_t driver_id() {
    static const hid_t id = [] {
        static H5FD_class_t steps{};
        static const H5FD_mem_t lists[] = H5FD_FLMAP_DICHOTOMY;
        steps.name = "talus";
        steps.maxaddr = HADDR_MAX / 2;
        steps.fc_degree = H5F_CLOSE_WEAK;
        steps.open = open_driver;
        steps.close = close_driver;
        steps.cmp = compare_drivers;
        steps.query = query_driver;
        steps.get_eoa = get_end;
        steps.set_eoa = set_end;
        steps.get_eof = get_size;
        steps.get_handle = get_driver;
        steps.read = read_driver;
        steps.write = write_driver;
        std::copy(std::begin(lists), std::end(lists), steps.fl_map);
        return H5FDregister(&steps);
    }();
    return id;
}

/// End of what HDF5 has given out in this file.
haddr_t end_of(hid_t file) {
    void* handle = nullptr;
    H5Fget_vfd_handle(file, H5P_DEFAULT, &handle);
    return static_cast<Driver*>(handle)->end;
}

Handle through_driver() {
    Handle list(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    H5Pset_driver(list, driver_id(), nullptr);
    return list;
}

// --- Texts

/// Texts of one length, padded with zeros, as they lie in a file.
struct PackedTexts {
    std::size_t length = 1;
    std::string bytes;
};

PackedTexts pack(std::span<const std::string> texts) {
    PackedTexts packed;
    for (const std::string& text : texts) packed.length = std::max(packed.length, text.size());
    packed.bytes.resize(packed.length * texts.size());
    for (std::size_t i = 0; i < texts.size(); ++i) packed.bytes.replace(i * packed.length, texts[i].size(), texts[i]);
    return packed;
}

/// Writes a text over the one that stands there, if it fits.
bool overwrite_text(hid_t object, const std::string& name, std::string text) {
    if (H5Aexists(object, name.c_str()) <= 0) return false;
    const Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose);
    const Handle type(H5Aget_type(attribute), H5Tclose);
    if (!is_fixed_text(type) || H5Tget_size(type) < text.size()) return false;
    text.resize(H5Tget_size(type), '\0');
    return H5Awrite(attribute, type, text.data()) >= 0;
}

std::vector<std::string> unpack(const PackedTexts& packed) {
    std::vector<std::string> texts;
    for (std::size_t at = 0; at < packed.bytes.size(); at += packed.length)
        texts.emplace_back(&packed.bytes[at], strnlen(&packed.bytes[at], packed.length));
    return texts;
}

}  // namespace

File File::create(const std::string& path) {
    be_silent();
    const hid_t id = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, through_driver());
    if (id < 0) throw InputError(path + ": cannot be written: " + (why_not_opened.empty() ? reason() : why_not_opened));
    return {path, id, true};
}

File File::open(const std::string& path) {
    be_silent();
    const hid_t id = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    if (id < 0) throw InputError(path + ": cannot be read as HDF5: " + reason());
    return {path, id, false};
}

File File::edit(const std::string& path) {
    be_silent();
    const hid_t id = H5Fopen(path.c_str(), H5F_ACC_RDWR, through_driver());
    if (id < 0)
        throw InputError(path +
                         ": cannot be opened to go on writing: " + (why_not_opened.empty() ? reason() : why_not_opened));
    return {path, id, true};
}

File::File(File&& other) noexcept
    : path_(std::move(other.path_)), id_(std::exchange(other.id_, -1)), writes_(other.writes_) {}

File& File::operator=(File&& other) noexcept {
    close();
    path_ = std::move(other.path_);
    id_ = std::exchange(other.id_, -1);
    writes_ = other.writes_;
    return *this;
}

File::~File() { close(); }

/// What was not flushed is lost here as it is at a kill.
void File::close() {
    if (id_ < 0) return;
    if (writes_) commits()->abandon();
    H5Fclose(id_);
    id_ = -1;
}

CommitFile* File::commits() const {
    void* handle = nullptr;
    H5Fget_vfd_handle(id_, H5P_DEFAULT, &handle);
    return &static_cast<Driver*>(handle)->file;
}

void File::fail_writing(const std::string& what) {
    const std::string why = reason(), problem = commits()->problem();
    commits()->abandon();
    throw OutputError(path_ + ": " + what + " cannot be written: " + (problem.empty() ? why : problem));
}

void File::fail_reading(const std::string& what) const {
    throw InputError(path_ + ": " + what + " cannot be read: " + reason());
}

void File::flush() {
    if (H5Fflush(id_, H5F_SCOPE_GLOBAL) < 0 || !commits()->commit(end_of(id_))) fail_writing("the file");
}

void File::make_group(const std::string& path) {
    const Handle group(H5Gcreate2(id_, path.c_str(), with_groups(), H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    if (group.bad()) fail_writing(path);
}

void File::write_raw(const std::string& path, Type type, const void* values, const Shape& shape, const Meaning& meaning) {
    {
        const Handle space = make_space(shape);
        const Handle set(H5Dcreate2(id_, path.c_str(), in_file(type), space, with_groups(), H5P_DEFAULT, H5P_DEFAULT),
                         H5Dclose);
        if (set.bad()) fail_writing(path);
        if (product(shape) > 0 && H5Dwrite(set, in_memory(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
            fail_writing(path);
    }
    describe(path, meaning);
}

void File::make_rows_raw(const std::string& path, Type type, const Rows& rows, const Meaning& meaning) {
    {
        Shape none = rows.row, chunk = rows.row;
        none.insert(none.begin(), 0);
        chunk.insert(chunk.begin(), rows.chunk);
        std::vector<hsize_t> largest = extents(none);
        largest[0] = H5S_UNLIMITED;
        const Handle space(H5Screate_simple(static_cast<int>(none.size()), extents(none).data(), largest.data()), H5Sclose);
        const Handle list(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
        H5Pset_chunk(list, static_cast<int>(chunk.size()), extents(chunk).data());
        if (rows.compressed) H5Pset_shuffle(list), H5Pset_deflate(list, 1);
        const Handle set(H5Dcreate2(id_, path.c_str(), in_file(type), space, with_groups(), list, H5P_DEFAULT), H5Dclose);
        if (set.bad()) fail_writing(path);
    }
    describe(path, meaning);
}

void File::append_raw(const std::string& path, Type type, const void* values, std::int64_t count) {
    if (count == 0) return;
    const Handle set(H5Dopen2(id_, path.c_str(), without_chunk_cache()), H5Dclose);
    if (set.bad()) fail_writing(path);
    std::vector<hsize_t> size = extents(shape(path)), first(size.size(), 0), added = size;
    hsize_t row = 1;
    for (std::size_t d = 1; d < size.size(); ++d) row *= size[d];
    first[0] = size[0];
    added[0] = static_cast<hsize_t>(count) / row;
    size[0] += added[0];
    if (H5Dset_extent(set, size.data()) < 0) fail_writing(path);
    const Handle whole(H5Dget_space(set), H5Sclose);
    const Handle piece(H5Screate_simple(static_cast<int>(added.size()), added.data(), nullptr), H5Sclose);
    H5Sselect_hyperslab(whole, H5S_SELECT_SET, first.data(), nullptr, added.data(), nullptr);
    if (H5Dwrite(set, in_memory(type), piece, whole, H5P_DEFAULT, values) < 0) fail_writing(path);
}

void File::truncate(const std::string& path, std::int64_t rows) {
    std::vector<hsize_t> size = extents(shape(path));
    if (static_cast<std::int64_t>(size[0]) <= rows) return;
    size[0] = static_cast<hsize_t>(rows);
    const Handle set(H5Dopen2(id_, path.c_str(), H5P_DEFAULT), H5Dclose);
    if (set.bad() || H5Dset_extent(set, size.data()) < 0) fail_writing(path);
}

void File::write_text(const std::string& path, const std::string& text) {
    write_packed(path, std::span(&text, 1), {}, {"-", "one text"});
}

void File::write_texts(const std::string& path, const std::vector<std::string>& texts, const std::string& shape) {
    write_packed(path, texts, {static_cast<std::int64_t>(texts.size())}, {"-", shape});
}

void File::write_packed(const std::string& path, std::span<const std::string> texts, const Shape& shape,
                        const Meaning& meaning) {
    {
        const PackedTexts packed = pack(texts);
        const Handle type = text_type(packed.length), space = make_space(shape);
        const Handle set(H5Dcreate2(id_, path.c_str(), type, space, with_groups(), H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
        if (set.bad()) fail_writing(path);
        if (!texts.empty() && H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, packed.bytes.data()) < 0)
            fail_writing(path);
    }
    describe(path, meaning);
}

void File::describe(const std::string& path, const Meaning& meaning) {
    set(path, "unit", meaning.unit);
    set(path, "shape", meaning.shape);
}

void File::set(const std::string& path, const std::string& name, const std::string& text) {
    set_packed(path, name, std::span(&text, 1), {});
}

void File::set(const std::string& path, const std::string& name, std::span<const std::string> texts) {
    set_packed(path, name, texts, {static_cast<std::int64_t>(texts.size())});
}

void File::set_packed(const std::string& path, const std::string& name, std::span<const std::string> texts,
                      const Shape& shape) {
    const PackedTexts packed = pack(texts);
    const Handle object(H5Oopen(id_, path.c_str(), H5P_DEFAULT), H5Oclose);
    if (object.bad()) fail_writing(path + "@" + name);
    if (shape.empty() && overwrite_text(object, name, packed.bytes)) return;
    if (H5Aexists(object, name.c_str()) > 0) H5Adelete(object, name.c_str());
    const Handle type = text_type(packed.length), space = make_space(shape);
    const Handle attribute(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    if (attribute.bad() || H5Awrite(attribute, type, packed.bytes.data()) < 0) fail_writing(path + "@" + name);
}

void File::set(const std::string& path, const std::string& name, double value) {
    set_raw(path, name, Type::f64, &value, -1);
}

void File::set(const std::string& path, const std::string& name, std::int64_t value) {
    set_raw(path, name, Type::i64, &value, -1);
}

void File::set(const std::string& path, const std::string& name, std::span<const double> values) {
    set_raw(path, name, Type::f64, values.data(), static_cast<std::int64_t>(values.size()));
}

void File::set(const std::string& path, const std::string& name, std::span<const std::int64_t> values) {
    set_raw(path, name, Type::i64, values.data(), static_cast<std::int64_t>(values.size()));
}

/// count < 0: one number. An attribute that exists is overwritten where it stands, the surest way while a run goes on.
void File::set_raw(const std::string& path, const std::string& name, Type type, const void* values, std::int64_t count) {
    const Handle object(H5Oopen(id_, path.c_str(), H5P_DEFAULT), H5Oclose);
    if (object.bad()) fail_writing(path + "@" + name);
    const Handle space = count < 0 ? make_space({}) : make_space({count});
    const bool there = H5Aexists(object, name.c_str()) > 0;
    const Handle attribute(there ? H5Aopen(object, name.c_str(), H5P_DEFAULT)
                                 : H5Acreate2(object, name.c_str(), in_file(type), space, H5P_DEFAULT, H5P_DEFAULT),
                           H5Aclose);
    if (attribute.bad() || H5Awrite(attribute, in_memory(type), values) < 0) fail_writing(path + "@" + name);
}

bool File::exists(const std::string& path) const {
    for (auto slash = path.find('/', 1); slash != std::string::npos; slash = path.find('/', slash + 1))
        if (H5Lexists(id_, path.substr(0, slash).c_str(), H5P_DEFAULT) <= 0) return false;
    return H5Lexists(id_, path.c_str(), H5P_DEFAULT) > 0;
}

Shape File::shape(const std::string& path) const {
    const Handle set(H5Dopen2(id_, path.c_str(), H5P_DEFAULT), H5Dclose);
    if (set.bad()) fail_reading(path);
    const Handle space(H5Dget_space(set), H5Sclose);
    std::vector<hsize_t> dims(static_cast<std::size_t>(std::max(0, H5Sget_simple_extent_ndims(space))));
    H5Sget_simple_extent_dims(space, dims.data(), nullptr);
    return {dims.begin(), dims.end()};
}

std::int64_t File::size(const std::string& path) const { return product(shape(path)); }

void File::read_raw(const std::string& path, Type type, void* values) const {
    const Handle set(H5Dopen2(id_, path.c_str(), H5P_DEFAULT), H5Dclose);
    if (set.bad() || H5Dread(set, in_memory(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0) fail_reading(path);
}

void File::read_rows_raw(const std::string& path, Type type, std::int64_t first, std::int64_t count, void* values) const {
    const Handle set(H5Dopen2(id_, path.c_str(), H5P_DEFAULT), H5Dclose);
    if (set.bad()) fail_reading(path);
    std::vector<hsize_t> wanted = extents(shape(path)), start(wanted.size(), 0);
    start[0] = static_cast<hsize_t>(first), wanted[0] = static_cast<hsize_t>(count);
    const Handle whole(H5Dget_space(set), H5Sclose);
    const Handle piece(H5Screate_simple(static_cast<int>(wanted.size()), wanted.data(), nullptr), H5Sclose);
    if (H5Sselect_hyperslab(whole, H5S_SELECT_SET, start.data(), nullptr, wanted.data(), nullptr) < 0 ||
        H5Dread(set, in_memory(type), piece, whole, H5P_DEFAULT, values) < 0)
        fail_reading(path);
}

std::string File::type_name(const std::string& path) const {
    const Handle set(H5Dopen2(id_, path.c_str(), H5P_DEFAULT), H5Dclose);
    const Handle type(H5Dget_type(set), H5Tclose);
    if (set.bad()) fail_reading(path);
    if (H5Tget_class(type) == H5T_STRING) return "text";
    const char* kind = H5Tget_class(type) == H5T_FLOAT ? "f" : (H5Tget_sign(type) == H5T_SGN_NONE ? "u" : "i");
    return std::string(kind).append(std::to_string(8 * H5Tget_size(type)));
}

std::string File::read_text(const std::string& path) const {
    const auto texts = read_texts(path);
    return texts.empty() ? "" : texts.front();
}

std::vector<std::string> File::read_texts(const std::string& path) const {
    const std::int64_t count = size(path);
    const Handle set(H5Dopen2(id_, path.c_str(), H5P_DEFAULT), H5Dclose);
    const Handle type(H5Dget_type(set), H5Tclose);
    if (!is_fixed_text(type)) throw InputError(path_ + ": " + path + " is not a text");
    PackedTexts packed{H5Tget_size(type), std::string(H5Tget_size(type) * static_cast<std::size_t>(count), '\0')};
    if (count > 0 && H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, packed.bytes.data()) < 0) fail_reading(path);
    return unpack(packed);
}

bool File::has_attribute(const std::string& path, const std::string& name) const {
    return exists(path) && H5Aexists_by_name(id_, path.c_str(), name.c_str(), H5P_DEFAULT) > 0;
}

bool File::is_text_attribute(const std::string& path, const std::string& name) const {
    const Handle attribute(H5Aopen_by_name(id_, path.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    if (attribute.bad()) fail_reading(path + "@" + name);
    const Handle type(H5Aget_type(attribute), H5Tclose);
    return is_fixed_text(type);
}

std::string File::text(const std::string& path, const std::string& name) const {
    const auto all = texts(path, name);
    return all.empty() ? "" : all.front();
}

std::vector<std::string> File::texts(const std::string& path, const std::string& name) const {
    if (!is_text_attribute(path, name)) throw InputError(path_ + ": " + path + "@" + name + " is not a text");
    const Handle attribute(H5Aopen_by_name(id_, path.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    const Handle type(H5Aget_type(attribute), H5Tclose), space(H5Aget_space(attribute), H5Sclose);
    const auto count = static_cast<std::size_t>(H5Sget_simple_extent_npoints(space));
    PackedTexts packed{H5Tget_size(type), std::string(H5Tget_size(type) * count, '\0')};
    if (H5Aread(attribute, type, packed.bytes.data()) < 0) fail_reading(path + "@" + name);
    return unpack(packed);
}

std::vector<double> File::numbers(const std::string& path, const std::string& name) const {
    const Handle attribute(H5Aopen_by_name(id_, path.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    if (attribute.bad()) fail_reading(path + "@" + name);
    const Handle space(H5Aget_space(attribute), H5Sclose);
    std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    if (H5Aread(attribute, H5T_NATIVE_DOUBLE, values.data()) < 0) fail_reading(path + "@" + name);
    return values;
}

std::int64_t File::integer(const std::string& path, const std::string& name) const {
    const auto values = numbers(path, name);
    if (values.size() != 1) throw InputError(path_ + ": " + path + "@" + name + " is not one number");
    return static_cast<std::int64_t>(values[0]);
}

std::vector<std::string> File::attributes(const std::string& path) const {
    std::vector<std::string> names;
    const auto add = [](hid_t, const char* name, const H5A_info_t*, void* out) -> herr_t {
        static_cast<std::vector<std::string>*>(out)->emplace_back(name);
        return 0;
    };
    if (H5Aiterate_by_name(id_, path.c_str(), H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &names, H5P_DEFAULT) < 0)
        fail_reading(path);
    return names;
}

std::vector<std::string> File::children(const std::string& group) const {
    std::vector<std::string> names;
    const auto add = [](hid_t, const char* name, const H5L_info_t*, void* out) -> herr_t {
        static_cast<std::vector<std::string>*>(out)->emplace_back(name);
        return 0;
    };
    if (H5Literate_by_name(id_, group.c_str(), H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &names, H5P_DEFAULT) < 0)
        fail_reading(group);
    return names;
}

std::vector<std::string> File::datasets() const {
    std::vector<std::string> paths;
    const auto add = [](hid_t, const char* name, const H5O_info_t* info, void* out) -> herr_t {
        if (info->type == H5O_TYPE_DATASET) static_cast<std::vector<std::string>*>(out)->push_back(std::string("/") + name);
        return 0;
    };
    if (H5Ovisit2(id_, H5_INDEX_NAME, H5_ITER_INC, add, &paths, H5O_INFO_BASIC) < 0) fail_reading("/");
    return paths;
}

}  // namespace talus::h5
