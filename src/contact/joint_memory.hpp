// From a joint face of the model to what its contact remembers.
#pragma once

#include "contact/face_path.hpp"
#include "model/model.hpp"

#include <span>

namespace talus {

/// `broken`: Contacts::broken, the cells of all faces.
inline FaceMemory joint_memory(const JointFace& face, const Joint& joint, std::span<const std::uint8_t> broken) {
    return {{face.s0, face.s1, face.sigma0 / joint.kn, face.sigma1 / joint.kn},
            face.bonded ? &broken[face.first_cell] : nullptr,
            joint.cells};
}

}  // namespace talus
