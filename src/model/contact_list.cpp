#include "model/contact_list.hpp"

#include "model/model.hpp"

#include <algorithm>
#include <limits>

namespace talus {
namespace {

constexpr int width = ContactColumns::size;
constexpr int rows = sizeof(FaceColumns) / sizeof(FaceColumns::Row);
static_assert(rows * sizeof(FaceColumns::Row) == sizeof(FaceColumns));

FaceColumns::Row* rows_of(FaceColumns& columns) { return reinterpret_cast<FaceColumns::Row*>(&columns); }

}  // namespace

void ContactColumns::load(int k, const Contact& c) {
    force[k] = c.shear_force, energy[k] = c.shear_energy, slip[k] = c.slip, slip_sum[k] = c.slip_sum;
    dilation[k] = c.dilation, slipped[k] = c.slipped, nx[k] = c.normal.x(), ny[k] = c.normal.y();
    sliding[k] = c.sliding, length[k] = c.length, overlap[k] = c.overlap, normal_force[k] = c.normal_force;
    strength[k] = c.strength, x[k] = c.point.x(), y[k] = c.point.y();
}

void ContactColumns::store(int k, Contact& c) const {
    if (length[k] > 0.0) c.touching = 1;
    c.sliding = sliding[k] != 0.0, c.slipped = slipped[k] != 0.0;
    c.length = length[k], c.overlap = overlap[k];
    c.normal_force = normal_force[k], c.shear_force = force[k], c.shear_energy = energy[k];
    c.strength = strength[k], c.slip = slip[k], c.slip_sum = slip_sum[k], c.dilation = dilation[k];
    c.point = {x[k], y[k]};
    c.normal = {nx[k], ny[k]};
}

void FaceColumns::load(int k, const Contact& c, const std::vector<JointFace>& faces) {
    ContactColumns::load(k, c);
    s0[k] = sigma0[k] = sigma1[k] = 0.0, s1[k] = std::numeric_limits<double>::infinity();
    if (c.face < 0) return;
    const JointFace& face = faces[c.face];
    s0[k] = face.s0, s1[k] = face.s1, sigma0[k] = face.sigma0, sigma1[k] = face.sigma1;
}

void FaceTable::insert(int at, int slot, const Contact& c, const std::vector<JointFace>& faces) {
    if (size() == width * static_cast<int>(columns_.size())) columns_.emplace_back();
    for (int batch = size() / width; batch >= at / width; --batch) {  // those from `at` on move on by one column
        FaceColumns::Row* row = rows_of(columns_[batch]);
        const int first = batch == at / width ? at % width : 0;
        for (int r = 0; r < rows; ++r) {
            if (batch < size() / width) rows_of(columns_[batch + 1])[r][0] = row[r][width - 1];
            std::copy_backward(row[r] + first, row[r] + width - 1, row[r] + width);
        }
    }
    slot_.insert(slot_.begin() + at, slot);
    columns_[at / width].load(at % width, c, faces);
}

void FaceTable::erase(int at) {
    const int last = (size() - 1) / width;
    for (int batch = at / width; batch <= last; ++batch) {
        FaceColumns::Row* row = rows_of(columns_[batch]);
        const int first = batch == at / width ? at % width : 0;
        for (int r = 0; r < rows; ++r) {
            std::copy(row[r] + first + 1, row[r] + width, row[r] + first);
            if (batch < last) row[r][width - 1] = rows_of(columns_[batch + 1])[r][0];
        }
    }
    slot_.erase(slot_.begin() + at);
}

void FaceTable::clear() {
    slot_.clear();
    columns_.clear();
}

void ContactList::catch_up() const {
    for (const FaceTable& table : tables_) table.store(list_);
    behind_ = false;
}

}  // namespace talus
