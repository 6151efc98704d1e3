#pragma once
// What a detector behind a patient with instruments in a vessel gets (D15):
//   I = I_0 sum_E S(E) exp(-sum_m mu_m(E) L_m)
// Lengths: a lumen displaces the soft body around it, bone too, an instrument the blood and iodine of the lumen that it is in (of
// a scene without a vessel, the body). Iodine adds c (mu/rho)_I to the blood. Scatter is not modelled: the contrast of a perfect
// grid.

#include "view/xray/bolus.h"
#include "view/xray/detector.h"
#include "view/xray/device_paths.h"
#include "view/xray/materials.h"
#include "view/xray/mesh_paths.h"
#include "view/xray/spectrum.h"

#include <optional>

namespace seldinger {

class Fluoroscope {
public:
    explicit Fluoroscope(std::vector<SpectrumLine> beam);

    // What stays: each forgets what was traced of it before.
    void set_view(const CArm& arm);
    /// @param wall  normals into the lumen; openings are closed. Empty: no vessel
    void set_wall(const WallMesh& wall);
    void set_bone(const WallMesh& bone);  // normals into it
    /// A soft body with these half axes (left, back, head) about the middle of the vessel, widened in proportion where that lies
    /// outside.
    void set_body(const Vec3& half_axes);
    void set_bolus(const Bolus& bolus);

    /// Instruments as they are now. @param of  materials that the stations number  @param time  of the bolus; none: no contrast
    void look(std::vector<Device> devices, const std::vector<Material>& of, std::optional<double> time);

    /// What arrives, without noise.
    [[nodiscard]] Exposure exposure();
    /// -ln(I/I_0) of that.
    [[nodiscard]] std::vector<float> line_integrals();
    /// Median of I/I_0 over the middle quarter of the detector without instruments and contrast: what an exposure is set by.
    [[nodiscard]] double reference();
    /// Pixels whose rays met a wall that is not closed.
    [[nodiscard]] long mended() const { return mended_; }
    [[nodiscard]] const CArmView& view() const { return view_; }

private:
    enum Matter { Soft, Blood, Bone, Iodine, MatterCount };
    struct Row {
        std::vector<float> amount[MatterCount];  // lengths [m]; of iodine, mass per area [kg/m^2]
    };
    void trace_still();
    void find_body();
    void fill_row(int row, bool full, Row& out) const;
    /// sum_m mu_m L_m of a row. @param full  with instruments and contrast
    void exponents(int row, std::size_t line, const Row& amounts, bool full, std::vector<float>& out) const;

    std::vector<SpectrumLine> beam_;
    double mean_energy_ = 0;
    CArm arm_;
    CArmView view_;
    WallMesh wall_, bone_;
    std::vector<float> arrival_;  // per vertex of the wall: time of travel of the bolus
    Vec3 body_half_ = Vec3::Zero(), body_centre_ = Vec3::Zero();
    std::optional<Bolus> bolus_;
    bool traced_ = false;
    std::vector<float> body_path_, bone_path_;
    MeshPaths lumen_;
    std::vector<std::size_t> interval_row_;  // [rows + 1] where each row's intervals begin
    long mended_ = 0;
    std::optional<double> reference_;
    std::vector<float> iodine_;  // [kg/m^2]; empty: none
    std::vector<DevicePath> devices_;
    std::vector<std::int32_t> device_row_;  // where each row's paths begin
    std::vector<std::vector<float>> mu_;    // per line of the beam: soft, blood, bone, iodine [1/m], [m^2/kg]
    std::vector<std::vector<float>> mu_device_;
};

}  // namespace seldinger
