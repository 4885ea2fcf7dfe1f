// The specification as Markdown tables for docs/scenario-reference.md. Shapes with a title get a section each.
#include "scenario/nearest.hpp"
#include "scenario/quantities.hpp"
#include "scenario/reader.hpp"
#include "scenario/specification.hpp"

#include <algorithm>
#include <set>

namespace talus {
namespace {

using Kind = spec::Shape::Kind;

std::string link_to(const std::string& title) {
    std::string anchor = title;
    std::replace(anchor.begin(), anchor.end(), ' ', '-');
    return "[" + title + "](#" + anchor + ")";
}

// Like Shape::text, with links to the sections, and bars that do not end the column.
std::string linked(const spec::Shape& shape) {
    if (!shape.title.empty()) return link_to(shape.title);
    if (shape.kind == Kind::names) return "table of NAME: " + linked(shape.of.front());
    if (shape.kind == Kind::either) {
        std::vector<std::string> all;
        for (const spec::Shape& alternative : shape.of) all.push_back(linked(alternative));
        return enumerate(all, " or ");
    }
    if (shape.kind == Kind::list && !shape.of.front().title.empty()) return "list of " + linked(shape.of.front());
    if (shape.kind == Kind::choice) {
        std::vector<std::string> words;
        for (const std::string& word : shape.words) words.push_back("`" + word + "`");
        return enumerate(words, ", ");
    }
    return shape.text();
}

std::string default_of(const spec::Key& key) {
    if (key.presence.required) return "**required**";
    if (!key.presence.value.empty()) return "`" + key.presence.value + "`";
    return key.presence.words;
}

class ReferenceWriter {
public:
    std::string whole(const spec::Shape& scenario) {
        section(scenario);
        quantity_table();
        return out_;
    }

private:
    void section(const spec::Shape& shape) {
        if (!shape.title.empty() && !done_.insert(shape.title).second) return;
        std::vector<const spec::Shape*> inner = shape.title.empty() ? parts(shape) : write(shape);
        for (const spec::Shape* part : inner) section(*part);
    }

    static std::vector<const spec::Shape*> parts(const spec::Shape& shape) {
        std::vector<const spec::Shape*> all;
        for (const spec::Shape& part : shape.of) all.push_back(&part);
        for (const spec::Key& key : shape.keys) all.push_back(&key.shape);
        return all;
    }

    std::vector<const spec::Shape*> write(const spec::Shape& shape) {
        out_ += "### " + shape.title + "\n\n";
        if (!shape.meaning.empty()) out_ += shape.meaning + "\n\n";
        if (shape.kind == Kind::table) {
            out_ += "| key | value | default | meaning |\n|---|---|---|---|\n";
            for (const spec::Key& key : shape.keys)
                out_ +=
                    "| `" + key.name + "` | " + linked(key.shape) + " | " + default_of(key) + " | " + key.meaning + " |\n";
            out_ += "\n";
        } else {
            spec::Shape bare = shape;
            bare.title.clear();
            out_ += "Value: " + linked(bare) + ".\n\n";
        }
        for (const spec::Rule& rule : shape.rules) out_ += rule_text(rule) + "\n\n";
        if (!shape.later.empty()) out_ += "Not available yet: `" + enumerate(shape.later, "`, `") + "`.\n\n";
        return parts(shape);
    }

    static std::string rule_text(const spec::Rule& rule) {
        std::string text = rule.count == spec::Rule::Count::exactly_one    ? "Exactly one of `"
                           : rule.count == spec::Rule::Count::at_least_one ? "At least one of `"
                                                                           : "At most one of `";
        text += enumerate(rule.keys, "`, `");
        return text + "`.";
    }

    void quantity_table() {
        out_ +=
            "### quantities\n\n| quantity | unit | place | components | in a history | meaning "
            "|\n|---|---|---|---|---|---|\n";
        for (const Quantity& quantity : quantities()) {
            std::vector<std::string> components;
            for (const std::string& component : quantity.components)
                components.push_back(component == quantity.component ? "**" + component + "**" : component);
            out_ += "| `" + quantity.name + "` | " + quantity.unit + " | " + place_text(quantity.place) + " | " +
                    enumerate(components) + " | " + (quantity.history ? "yes" : "no") + " | " + quantity.meaning + " |\n";
        }
        out_ += "\nThe component in bold is the default of `expect`; without one in bold it must be given.\n";
    }

    std::set<std::string> done_;
    std::string out_;
};

}  // namespace

std::string scenario_reference_tables() { return ReferenceWriter().whole(spec::scenario()); }

}  // namespace talus
