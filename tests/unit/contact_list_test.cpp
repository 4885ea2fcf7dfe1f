#include "model/contact_list.hpp"
#include "core/random.hpp"
#include "model/model.hpp"
#include "support/catch.hpp"

#include <algorithm>
#include <utility>

using namespace talus;

namespace {

Contact contact(int number) {
    const double x = number;
    Contact c{.part_a = number, .part_b = number + 1, .joint = 0};
    c.alive = c.touching = 1;
    c.slipped = number % 2, c.sliding = number % 3 == 0;
    c.length = x + 0.1, c.overlap = x + 0.2, c.normal_force = x + 0.3, c.shear_force = x + 0.4, c.shear_energy = x + 0.5;
    c.strength = x + 0.6, c.slip = x + 0.7, c.slip_sum = x + 0.8, c.dilation = x + 0.9;
    c.point = {x + 0.11, x + 0.12}, c.normal = {x + 0.13, x + 0.14};
    return c;
}

bool same(const Contact& a, const Contact& b) {
    return a.part_a == b.part_a && a.touching == b.touching && a.slipped == b.slipped && a.sliding == b.sliding &&
           a.length == b.length && a.overlap == b.overlap && a.normal_force == b.normal_force &&
           a.shear_force == b.shear_force && a.shear_energy == b.shear_energy && a.strength == b.strength &&
           a.slip == b.slip && a.slip_sum == b.slip_sum && a.dilation == b.dilation && a.point == b.point &&
           a.normal == b.normal;
}

}  // namespace

TEST_CASE("a list that is read knows what stands in columns, however many came and went") {
    Random random(17);
    constexpr int n = 70;
    ContactList list;
    for (int i = 0; i < n; ++i) list.edit().push_back({.part_a = i, .part_b = i + 1, .joint = 0});
    list.tables().resize(1);
    FaceTable& table = list.tables().front();
    std::vector<int> there;  // ascending
    for (int turn = 0; turn < 2000; ++turn) {
        const int slot = static_cast<int>(n * random.uniform());
        const auto place = std::ranges::lower_bound(there, slot);
        const int at = static_cast<int>(place - there.begin());
        if (place != there.end() && *place == slot) {
            table.erase(at);
            there.erase(place);
        } else {
            table.insert(at, slot, contact(slot), {});
            there.insert(place, slot);
        }
        REQUIRE(table.size() == static_cast<int>(there.size()));
        if (turn % 100 != 0) continue;
        ContactList copy = list;
        copy.fall_behind();
        const std::vector<Contact>& now = copy.read();
        for (int i = 0; i < n; ++i) {
            const bool in_columns = std::ranges::binary_search(there, i);
            CHECK(same(now[i], in_columns ? contact(i) : list.key(i)));
        }
    }
}

TEST_CASE("whoever takes the list of contacts to change it gets it up to date, and what stood in columns counts no more") {
    ContactList list{contact(3)};
    list.tables().resize(1);
    Contact later = contact(3);
    later.slip = 17.0;
    list.tables().front().insert(0, 0, later, {});
    list.fall_behind();
    CHECK(list.key(0).slip == contact(3).slip);
    Contact& mine = list[0];
    CHECK(mine.slip == 17.0);
    mine.slip = 18.0;
    CHECK(list.tables().empty());
    CHECK(std::as_const(list)[0].slip == 18.0);
}
