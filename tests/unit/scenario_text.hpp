// Scenarios for the tests of the reader.
#pragma once

#include <string>

namespace talus::test {

/// Every section of the file, most of its keys.
inline const std::string full_scenario = R"(title: Everything at once
source: made for the test
gravity: [0, -9.81]
body_acceleration: {time: [0, 0.5, 1], x: [0, 2.5, 0], y: [0, 0, 0]}
materials:
  granite: {density: 2600}
  shale: {density: 2400}
joints:
  bedding: &bedding
    normal_stiffness: 1e10
    shear_stiffness: 5e9
    friction_angle_deg: 30
    cohesion: 1e5
    tension: 2.0e4
    dilation_angle_deg: 5
    dilation_cutoff_slip: .01
    residual: {cohesion: 0}
    cells: 4
  floor: {normal_stiffness: 2e10, shear_stiffness: 1e10, friction_angle_deg: 45}
  copy: *bedding
contacts:
  default: floor
  materials: [{a: granite, b: shale, joint: bedding}]
  blocks: [{a: wall, b: plate, joint: copy}]
rock:
  outline: [[0, 0], [60, 0], [60, 15], [40, 15], [25, 40], [0, 40]]
  material: granite
  joint_sets:
    - {angle_deg: -35, spacing: 2, joint: bedding}
    - name: cross
      angle_deg: {mean: 70, deviation: 5}
      spacing: {mean: 3, deviation: 0.6, distribution: lognormal}
      persistence: 0.8
      seed: 7
      origin: [1, 2]
      inside: [[0, 0], [10, 0], [10, 10], [0, 10]]
  cracks: [{points: [[1, 1], [5, 5]], joint: floor}]
  holes: [{circle: {center: [10, 10], radius: 2, sides: 8}}]
  regions:
    tunnel: {circle: {center: [20, 10], radius: 3}, material: shale}
    cap: {outline: [[0, 30], [0, 40], [10, 40], [10, 30]]}
  held: {left: true, right: roller, below: 2.0, inside: [[[0, 0], [1, 0], [1, 1]]]}
  slivers: {area: 1e-4}
blocks:
  - name: wall
    rectangle: {corner: [100, 0], size: [2, 1]}
    material: granite
    repeat: [{count: 2, step: [0, 1], stagger: [0.5, 0]}, {count: 3, step: [2, 0]}]
  - name: arch
    arch: {center: [200, 0], radius: 5, thickness: 1, count: 4}
    material: shale
    held: [true, true, false]
  - name: plate
    outline: [[100, -1], [110, -1], [110, 0], [100, 0]]
    material: granite
    held: true
    driven: {velocity_x: {time: [0, 1], value: [0, 0.5]}, velocity_y: 0}
  - {outline: [[50, 50], [50, 51], [51, 51]], material: granite, velocity: [1, -2], spin: 0.5}
loads:
  - {block: "wall[0][1]", force: [0, -1000], point: [103, 1]}
  - {block: {at: [5, 5]}, force: {time: [0, 1], x: [0, 10], y: [0, 0]}, moment: 3}
initial_stress: {k0: 0.5, surface: 40, surcharge: 1e4, left: true}
stages:
  - {settle: true}
  - name: excavate
    delete: [tunnel, {region: cap}, [30, 20], {inside: [[0, 0], [1, 0], [1, 1]]}]
    release: 0.5
    change: {joints: {bedding: {friction_angle_deg: 20, residual: {friction_angle_deg: 15}}}}
    gravity: {time: [0, 1], x: [0, 1], y: [-9.81, -9.81]}
    loads: []
    until: {time: 1}
    damping: {local: 0.5, contact: 1e-4}
    time_step: 1e-5
  - {name: weaken, change: {joints: {bedding: {cohesion: 5e4}}}, until: {equilibrium: 1e-5}}
run:
  until: {time: 2.0}
  solver: explicit
  time_step: 2e-5
  unchecked: true
  search: dess
  skin: 0.01
  face_path: false
  threads: 2
record:
  frames: {every: 0.05}
  history:
    - {point: [30, 30], every: 0.001}
    - {name: joint, joint: [10, 20], quantities: [normal_stress, opening]}
    - {block: plate, quantity: reaction, component: y}
  contacts: false
expect:
  - {quantity: displacement, point: [30, 30], at: end, value: 1.23, tolerance: 0.01}
  - {quantity: acceleration, direction_deg: -30, block: plate, between: [0.5, 1], value: 0, tolerance_absolute: 1e-6}
  - {quantity: frequency, of: rotation, point: [30, 30], above: 2}
  - {quantity: loop_area, joint: [10, 20], value: 5, tolerance: 0.02}
  - {quantity: normal_stress, joint: [10, 20], at: max, between: [0, 1], below: 1e6}
  - {quantity: energy, component: kinetic, at: 0.5, below: 1}
  - {quantity: stable}
  - {quantity: unstable, point: [30, 30], limit: 0.1}
)";

/// The least that is a scenario: one block that falls. Line 5 and following are free.
inline const std::string small_scenario = R"(gravity: [0, -10]
materials: {rock: {density: 2500}}
blocks: [{name: cube, outline: [[0, 0], [1, 0], [1, 1], [0, 1]]}]
run: {until: {time: 1}}
)";

}  // namespace talus::test
