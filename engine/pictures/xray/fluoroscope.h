#pragma once
// What a detector behind a patient with instruments in a vessel gets (D15):
//   I = I_0 sum_E S(E) exp(-sum_m mu_m(E) L_m)
// Lengths: a lumen displaces the soft body around it, bone too, an instrument the blood and iodine of the lumen that it is in (of
// a scene without a vessel, the body). Iodine adds c (mu/rho)_I to the blood. Scatter is not modelled: the contrast of a perfect
// grid.
// Body, bones and vessel are traced and their energies summed once for a view; a picture sums again only the rays that an
// instrument or iodine is in. The picture does not depend on earlier pictures.

#include "xray/beam.h"
#include "xray/bolus.h"
#include "xray/device_paths.h"
#include "xray/exposure.h"
#include "xray/mesh_paths.h"

#include <optional>

namespace seldinger {

class Fluoroscope {
public:
    explicit Fluoroscope(std::vector<SpectrumLine> beam);

    // Constant parts; each call discards the traces of the part before.
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

    /// What arrives, without noise; it stands until the next.
    [[nodiscard]] const Exposure& exposure();
    /// -ln(I/I_0) of that.
    [[nodiscard]] std::vector<float> line_integrals();
    /// Thickness of the vessel along each pixel's ray [rows x columns] [m]; zero without one.
    [[nodiscard]] std::vector<float> lumen_thickness() const;
    /// Median of I/I_0 over the middle quarter of the detector without instruments and contrast: what an exposure is set by.
    [[nodiscard]] double reference();
    /// Pixels whose rays met a wall that is not closed.
    [[nodiscard]] long mended() const { return mended_; }
    [[nodiscard]] const CArmView& view() const { return view_; }

private:
    void trace_still();
    /// Centre and width of the body, which the vessel's vertices say: of an arm that turns, once.
    void fit_body();
    void find_body();
    void carry_iodine(std::vector<Device>& devices) const;
    /// What arrives without instruments and contrast.
    const Exposure& still();
    [[nodiscard]] std::vector<std::int32_t> every_column() const;
    /// Iodine that a row's rays meet [columns], or empty.
    [[nodiscard]] std::vector<float> iodine_of(int row) const;
    /// Columns of a row whose rays meet instruments or iodine.
    [[nodiscard]] std::vector<std::int32_t> changed_columns(int row, const std::vector<float>& iodine) const;
    /// What the rays of these columns run through, without instruments and contrast.
    void pack_still(int row, const std::vector<std::int32_t>& columns, Rays& out) const;
    /// With them.
    void pack(int row, const std::vector<std::int32_t>& columns, const std::vector<float>& iodine, Rays& out) const;

    Beam beam_;
    CArm arm_;
    CArmView view_;
    WallMesh wall_, bone_;
    std::vector<float> arrival_;  // per vertex of the wall: time of travel of the bolus
    Vec3 body_half_ = Vec3::Zero();
    bool body_fits_ = false;
    Vec3 body_centre_ = Vec3::Zero(), body_half_wide_ = Vec3::Zero();
    std::optional<Bolus> bolus_;
    // of the view, until it or what stays changes
    bool traced_ = false, summed_ = false;
    std::vector<float> body_path_, bone_path_;
    MeshPaths lumen_;
    std::vector<std::size_t> interval_row_;  // [rows + 1] where each row's intervals begin
    long mended_ = 0;
    Exposure still_;
    std::optional<double> reference_;
    // of the picture
    std::optional<BolusMoment> iodine_;  // none: no contrast
    std::vector<DevicePath> devices_;
    std::vector<std::int32_t> device_row_;  // [rows + 1] where each row's paths begin
    Exposure exposure_;
};

}  // namespace seldinger
