// YADE as one of the other codes. What makes it fast (YADE 2023.02a, each tried by itself): a Verlet distance
// of a tenth of the smallest radius instead of half, and nothing in the loop that it can do without.
#include <fmt/format.h>

#include <fstream>
#include <stdexcept>

#include "experiments/workflows/benchmarks/other_codes.hpp"

namespace loam::experiments {
namespace {

/// The material and the interaction loop of a law.
std::string interactions(const SharedWork& work) {
    const SharedParameters& p = work.parameters;
    const std::string elastic =
        fmt::format("young={}, poisson={}, frictionAngle={}, density={}", p.young_modulus,
                    work.law == SharedLaw::hertz ? p.poisson_ratio : p.stiffness_ratio, p.friction_angle,
                    work.grain_density);
    switch (work.law) {
        case SharedLaw::cohesive:
            return fmt::format(
                "material = CohFrictMat({}, isCohesive=True, normalCohesion={}, shearCohesion={}, "
                "momentRotationLaw=False)\n"
                "loop = InteractionLoop([Ig2_Sphere_Sphere_ScGeom6D()],\n"
                "    [Ip2_CohFrictMat_CohFrictMat_CohFrictPhys(setCohesionNow=True, "
                "setCohesionOnNewContacts=True)],\n"
                "    [Law2_ScGeom6D_CohFrictPhys_CohesionMoment()])\n",
                elastic, p.cohesion, p.cohesion);
        case SharedLaw::linear:
            return fmt::format(
                "material = FrictMat({})\n"
                "loop = InteractionLoop([Ig2_Sphere_Sphere_ScGeom()], [Ip2_FrictMat_FrictMat_FrictPhys()],\n"
                "    [Law2_ScGeom_FrictPhys_CundallStrack()])\n",
                elastic);
        case SharedLaw::hertz:
            return fmt::format(
                "material = FrictMat({})\n"
                "loop = InteractionLoop([Ig2_Sphere_Sphere_ScGeom()],\n"
                "    [Ip2_FrictMat_FrictMat_MindlinPhys(en={}, es={})], "
                "[Law2_ScGeom_MindlinPhys_Mindlin()])\n",
                elastic, p.restitution, p.restitution);
    }
    throw std::logic_error("unknown law");
}

// The clock is read by an engine of the loop, because waiting for a run ends up to 40 ms late. The folder
// that YADE makes for itself goes at once: it stays behind when a run ends other than by itself.
constexpr std::string_view yade_script = R"(import os, time
try: os.rmdir(os.path.dirname(O.tmpFilename()))
except OSError: pass
O.periodic = True
O.cell.setBox({cell_x}, {cell_y}, {cell_z})
{interactions}O.materials.append(material)
for line in open('packing.txt'):
    x, y, z, radius = (float(word) for word in line.split())
    ball = sphere((x, y, z), radius, material=material)
    ball.state.blockedDOFs = '{blocked}'
    O.bodies.append(ball)
times = []
def note_time(): times.append((O.iter, time.process_time()))
O.engines = [ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb()], allowBiggerThanPeriod=True, verletDist=-0.05),
    loop,
    NewtonIntegrator(damping={damping}),
    PyRunner(command='note_time()', iterPeriod={steps}, firstIterRun={warm_up}, initRun=False)]
O.trackEnergy = False
O.dt = {time_step}
O.cell.velGrad = Matrix3(0, 0, 0, 0, 0, 0, 0, 0, -{strain_rate})
O.run({all_steps}, True)
(first, start), (last, end) = times[-2:]
assert last - first == {steps}
print('loam-bench seconds', end - start)
print('loam-bench contacts', sum(1 for i in O.interactions if i.isReal))
)";

void write_packing(const engine::Packing& packing, const std::filesystem::path& file) {
    std::ofstream out(file);
    for (Eigen::Index k = 0; k < packing.radii.size(); ++k)
        out << fmt::format("{} {} {} {}\n", packing.centres(0, k), packing.centres(1, k),
                           packing.centres(2, k), packing.radii[k]);
    if (!out.flush()) throw std::runtime_error(file.string() + " cannot be written");
}

}  // namespace

std::vector<std::string> write_yade_input(const SharedWork& work, const std::filesystem::path& folder) {
    write_packing(work.packing, folder / "packing.txt");
    const auto& cell = work.packing.cell;
    std::ofstream out(folder / "work.py");
    out << fmt::format(yade_script, fmt::arg("cell_x", cell(0, 0)), fmt::arg("cell_y", cell(1, 1)),
                       fmt::arg("cell_z", cell(2, 2)), fmt::arg("interactions", interactions(work)),
                       fmt::arg("blocked", work.free_rotation ? "" : "XYZ"),
                       fmt::arg("damping", work.damping), fmt::arg("steps", work.steps),
                       fmt::arg("warm_up", work.warm_up), fmt::arg("time_step", work.time_step),
                       fmt::arg("strain_rate", work.strain_rate),
                       fmt::arg("all_steps", work.warm_up + work.steps + 2));
    if (!out.flush()) throw std::runtime_error("the input of yade cannot be written");
    return {"-n", "-x", "-j1", "work.py"};
}

std::optional<Timing> read_yade_output(std::string_view output, const SharedWork&) {
    const auto seconds = said_number(output, "seconds"), contacts = said_number(output, "contacts");
    if (!seconds || !contacts) return std::nullopt;
    return Timing{*seconds, *contacts};
}

}  // namespace loam::experiments
