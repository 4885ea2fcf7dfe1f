// The contacts of a state, and where their numbers are while many of them are computed at a time.
//
// What plain faces know stands in columns, which a step reads and writes as whole vectors: a contact that is gathered from
// the list and put back costs as much as its mechanics. Whoever reads the list gets it up to date, whoever takes it to
// change it ends the columns; the next step makes them anew.
#pragma once

#include "model/contact.hpp"

#include <initializer_list>
#include <utility>
#include <vector>

namespace talus {

struct JointFace;

/// One row of numbers per quantity, one column per contact; names as in Contact. Flags are 0 or 1.
struct alignas(64) ContactColumns {
    static constexpr int size = 16;
    using Row = double[size];

    Row force, energy, slip, slip_sum, dilation, slipped, nx, ny;  // what the next step needs; of the shear, and the normal
    Row sliding, length, overlap, normal_force, strength, x, y;    // what is only read; x, y: centre of pressure

    void load(int k, const Contact& c);
    void store(int k, Contact& c) const;
};

/// With the stress that a face was built with (Pa, at s0 and s1 along it); s1 is infinite where there is none.
struct FaceColumns : ContactColumns {
    Row s0, s1, sigma0, sigma1;

    void load(int k, const Contact& c, const std::vector<JointFace>& faces);
};

/// Plain faces that are computed in one go, in the order of the list.
class FaceTable {
public:
    int size() const { return static_cast<int>(slot_.size()); }
    FaceColumns& columns(int batch) { return columns_[batch]; }  // contacts from batch x FaceColumns::size on
    void insert(int at, int slot, const Contact& c, const std::vector<JointFace>& faces);
    void erase(int at);
    void clear();

    void store(int at, std::vector<Contact>& list) const {
        columns_[at / FaceColumns::size].store(at % FaceColumns::size, list[slot_[at]]);
    }
    void store(std::vector<Contact>& list) const {
        for (int at = 0; at < size(); ++at) store(at, list);
    }

private:
    std::vector<int> slot_;  // in the list, ascending
    std::vector<FaceColumns> columns_;
};

/// Sorted by key. Like a vector; not to be read by several threads before one has.
class ContactList {
public:
    ContactList() = default;
    ContactList(std::vector<Contact> list) : list_(std::move(list)) {}
    ContactList(std::initializer_list<Contact> list) : list_(list) {}

    const std::vector<Contact>& read() const {
        if (behind_) catch_up();
        return list_;
    }
    operator const std::vector<Contact>&() const { return read(); }
    auto begin() const { return read().begin(); }
    auto end() const { return read().end(); }
    const Contact& operator[](std::size_t i) const { return read()[i]; }
    const Contact& front() const { return read().front(); }
    std::size_t size() const { return list_.size(); }
    bool empty() const { return list_.empty(); }
    /// Of its members only those hold that a step leaves as they are: parts, joint, face and edges.
    const Contact& key(std::size_t i) const { return list_[i]; }

    std::vector<Contact>& edit() {
        read();
        tables_.clear();
        return list_;
    }
    auto begin() { return edit().begin(); }
    auto end() { return edit().end(); }
    Contact& operator[](std::size_t i) { return edit()[i]; }
    Contact& front() { return edit().front(); }
    void push_back(const Contact& c) { edit().push_back(c); }
    void clear() { edit().clear(); }

    // ---- for the loop over all contacts, which knows what stands where

    std::vector<Contact>& behind() { return list_; }
    std::vector<FaceTable>& tables() { return tables_; }  // one per chunk of the list; none = it is all in the list
    void fall_behind() { behind_ = true; }

private:
    void catch_up() const;

    mutable std::vector<Contact> list_;
    std::vector<FaceTable> tables_;
    mutable bool behind_ = false;  // the tables know more
};

}  // namespace talus
