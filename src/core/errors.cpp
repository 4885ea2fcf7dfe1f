#include "core/errors.hpp"

namespace talus {
namespace {

std::string report(const std::vector<Fault>& faults) {
    std::string all;
    for (const Fault& fault : faults) all += (all.empty() ? "" : "\n") + fault.text();
    return all;
}

}  // namespace

std::string Fault::text() const {
    std::string place = where.file;
    if (where.line > 0) place += ":" + std::to_string(where.line);
    if (!place.empty()) place += " ";
    return place + (key.empty() ? "" : key + ": ") + message;
}

InputError::InputError(std::vector<Fault> faults) : std::runtime_error(report(faults)), faults_(std::move(faults)) {}
InputError::InputError(const std::string& message) : InputError(std::vector<Fault>{{{}, {}, message}}) {}

}  // namespace talus
