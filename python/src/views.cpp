// Names, shapes and units of the readings of a world.
#include "views.h"


#include <cstddef>

namespace seldinger::python {
namespace {

/// A read-only view of `from`, which lives as long as `owner`.
py::array view(const py::dtype& type, std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides, const void* from,
               const std::shared_ptr<const Output>& owner)
{
    auto* held = new std::shared_ptr<const Output>(owner);
    const py::capsule keeper(held, [](void* at) { delete static_cast<std::shared_ptr<const Output>*>(at); });
    py::array made(type, std::move(shape), std::move(strides), from, keeper);
    py::detail::array_proxy(made.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
    return made;
}

constexpr py::ssize_t real = sizeof(double);

py::array numbers(const std::vector<double>& from, const std::shared_ptr<const Output>& owner)
{
    return view(py::dtype::of<double>(), {static_cast<py::ssize_t>(from.size())}, {real}, from.data(), owner);
}

py::array points(const std::vector<Vec3>& from, const std::shared_ptr<const Output>& owner)
{
    return view(py::dtype::of<double>(), {static_cast<py::ssize_t>(from.size()), 3}, {3 * real, real}, from.data(), owner);
}

py::dtype contact_type()
{
    static_assert(std::is_standard_layout_v<ContactSide>);
    py::list names, formats, offsets;
    const auto field = [&](const char* name, const char* format, std::size_t offset) {
        names.append(name), formats.append(format), offsets.append(offset);
    };
    constexpr std::size_t b = offsetof(ContactRow, b);
    field("instrument", "<i4", offsetof(ContactRow, a) + offsetof(ContactSide, body));
    field("edge", "<i4", offsetof(ContactRow, a) + offsetof(ContactSide, element));
    field("with_wall", "<i4", b + offsetof(ContactSide, kind));
    field("other", "<i4", b + offsetof(ContactSide, body));
    field("element", "<i4", b + offsetof(ContactSide, element));
    field("point", "(3,)<f8", offsetof(ContactRow, point));
    field("normal", "(3,)<f8", offsetof(ContactRow, normal));
    field("gap", "<f8", offsetof(ContactRow, gap));
    field("normal_force", "<f8", offsetof(ContactRow, normal_force));
    field("friction", "(3,)<f8", offsetof(ContactRow, friction));
    field("rolling_moment", "<f8", offsetof(ContactRow, rolling_moment));
    field("stuck", "?", offsetof(ContactRow, stuck));
    field("along", "<f8", offsetof(ContactRow, along_a));
    field("along_other", "<f8", offsetof(ContactRow, along_b));
    field("length", "<f8", offsetof(ContactRow, length));
    field("area", "<f8", offsetof(ContactRow, area));
    field("pressure", "<f8", offsetof(ContactRow, pressure));
    field("force_per_length", "<f8", offsetof(ContactRow, per_length));
    field("region", "<i4", offsetof(ContactRow, region));
    return py::dtype(names, formats, offsets, sizeof(ContactRow));
}

py::array contacts(const std::shared_ptr<const Output>& data)
{
    const std::vector<ContactRow>& rows = data->contacts;
    return view(contact_type(), {static_cast<py::ssize_t>(rows.size())}, {static_cast<py::ssize_t>(sizeof(ContactRow))},
                rows.data(), data);
}

py::array vector(const Vec3& v)
{
    py::array_t<double> made(3);
    std::copy(v.data(), v.data() + 3, made.mutable_data());
    return made;
}

py::dict ledger(const EnergyLedger& e)
{
    py::dict d;
    d["hand"] = e.hand, d["outside"] = e.outside, d["forces"] = e.forces;
    d["material"] = e.material, d["remesh"] = e.remesh, d["wire"] = e.wire;
    d["friction"] = e.friction, d["contact"] = e.contact, d["wall"] = e.wall, d["damping"] = e.damping, d["scheme"] = e.scheme;
    d["open"] = e.open();
    return d;
}

/// What an Output (of its first instrument) and an InstrumentOutput have alike.
template <class View, class Get>
void add_wire(py::class_<View>& c, Get get)
{
    const auto number = [&](const char* name, double WireReadings::*member, const char* text) {
        c.def_property_readonly(
            name, [get, member](const View& v) { return get(v).readings.*member; }, text);
    };
    const auto array = [&](const char* name, auto member, const char* text) {
        c.def_property_readonly(
            name,
            [get, member](const View& v) {
                if constexpr (std::is_same_v<decltype(member), std::vector<double> WireOutput::*>)
                    return numbers(get(v).*member, v.data);
                else return points(get(v).*member, v.data);
            },
            text);
    };
    array("nodes", &WireOutput::position, "[n, 3] float64, m: the wire's axis, tip first. A read-only view.");
    array("velocity", &WireOutput::velocity, "[n, 3] float64, m/s. A read-only view.");
    array("contact_force", &WireOutput::contact_force, "[n, 3] float64, N: of the wall on each node. A read-only view.");
    array("material_s", &WireOutput::material_s, "[n] float64, m: arc length from the tip along the unstressed wire.");
    array("radius", &WireOutput::radius, "[n] float64, m: of the edge that begins at the node.");
    array("curvature", &WireOutput::curvature, "[n] float64, 1/m; 0 at the ends.");
    array("spin", &WireOutput::spin, "[n] float64, rad: of the material, right-handed about the direction of insertion.");
    array("director", &WireOutput::director,
          "[n, 3] float64: the first director of the material, a unit vector. A read-only view.");
    c.def_property_readonly(
        "tip", [get](const View& v) { return vector(get(v).tip); }, "[3] float64, m.");
    c.def_property_readonly(
        "base_force", [get](const View& v) { return vector(get(v).readings.base_force); }, "[3] float64, N.");
    number("inserted", &WireReadings::inserted, "float, m: advance since the start.");
    number("turned", &WireReadings::turned, "float, rad: by the hub, right-handed about the direction of insertion.");
    number("hand_force", &WireReadings::hand_force, "float, N: on the hand, + resists insertion.");
    number("hand_torque", &WireReadings::hand_torque, "float, N m.");
    number("wall_force", &WireReadings::normal, "float, N: sum of the normal contact forces' magnitudes.");
    number("friction_force", &WireReadings::friction, "float, N: sum of the friction forces' magnitudes.");
    number("contact_length", &WireReadings::contact_length, "float, m: of wire in contact.");
    number("overlap", &WireReadings::overlap, "float, m: deepest overlap with the wall, >= 0.");
    number("outside", &WireReadings::outside, "float, m: farthest point of the axis beyond the wall, >= 0.");
    number("kinetic", &WireReadings::kinetic, "float, J.");
    number("elastic", &WireReadings::elastic, "float, J.");
    number("gravitational", &WireReadings::gravitational, "float, J.");
    number("force_energy", &WireReadings::force_energy, "float, J: potential energy of forces of your own (`Force.energy`).");
    number("force_residual", &WireReadings::force_residual, "float, N: largest residual on a free node.");
    c.def_property_readonly(
        "contact_count", [get](const View& v) { return get(v).readings.contacts; }, "int.");
    const auto along = [&](const char* name, double ContactAlong::*value, const char* doc) {
        c.def_property_readonly(name, [get, value](const View& v) { return get(v).on_wall.*value; }, doc);
    };
    along("force_per_length", &ContactAlong::per_length_max,
          "float, N/m: largest load of the wall per length of wire, over `force_window` (docs/readings.md).");
    along("force_window", &ContactAlong::window, "float, m: window of force_per_length.");
    along("patch_force", &ContactAlong::patch_force, "float, N: largest load of the wall on one patch of `force_patch`.");
    along("force_patch", &ContactAlong::patch, "float, m: length of the patch.");
    along("contact_extent", &ContactAlong::extent,
          "float, m: total length of the regions in contact, gaps up to one window closed.");
    c.def_property_readonly(
        "contact_regions", [get](const View& v) { return get(v).on_wall.regions; },
        "int: regions in contact with the wall, more than one window apart.");
    c.def_property_readonly(
        "energy", [get](const View& v) { return ledger(get(v).readings.energy); },
        "dict of float, J: the energy balance.");
    c.def_property_readonly(
        "sensors",
        [get](const View& v) {
            py::dict all;
            for (const SensorOutput& sensor : get(v).sensors)
                for (std::size_t k = 0; k < sensor.columns.size(); ++k) {
                    if (k == 0) all[py::str(sensor.name)] = py::dict();
                    all[py::str(sensor.name)][py::str(sensor.columns[k])] = sensor.values[k];
                }
            return all;
        },
        "dict of dict of float: what each sensor last measured (`Force.record`), by name and column.");
    c.def_property_readonly(
        "at_rest", [get](const View& v) { return get(v).at_rest; }, "bool.");
    c.def_property_readonly(
        "failed", [get](const View& v) { return get(v).report.failed(); }, "bool: of its last step.");
}

py::list walls(const OutputView& v)
{
    py::list all;
    for (const WallOutput& wall : v.data->walls) {
        py::dict d;
        d["move_max"] = wall.readings.move_max;
        d["displacement"] = points(wall.displacement, v.data);
        d["stress"] = numbers(wall.stress, v.data);
        all.append(d);
    }
    return all;
}

}  // namespace

void bind_output(py::module_& module)
{
    py::class_<WireView> wire(module, "InstrumentOutput", "One instrument of an Output.");
    add_wire(wire, [](const WireView& v) -> const WireOutput& { return v.wire(); });
    wire.def_property_readonly(
        "time", [](const WireView& v) { return v.wire().time; }, "float, s: simulated time.");
    made_here_only(wire);

    py::class_<OutputView> output(
        module, "Output",
        "Readings of a world. Numbers and arrays without an instrument are the first one's. They keep "
        "their values when the world continues or is deleted.");
    add_wire(output, [](const OutputView& v) -> const WireOutput& { return v.data->wires.front(); });
    output.def_property_readonly(
        "time", [](const OutputView& v) { return v.data->time; }, "float, s.");
    output.def_property_readonly(
        "step", [](const OutputView& v) { return v.data->step; }, "int: steps since the start.");
    output.def_property_readonly(
        "contacts", [](const OutputView& v) { return contacts(v.data); },
        "[c] structured: all contacts, sorted by (instrument, edge, element). A read-only view.");
    output.def_property_readonly("walls", &walls, "list of dict, one per system with an elastic wall.");
    output.def_property_readonly(
        "instruments",
        [](const OutputView& v) {
            py::list all;
            for (std::size_t k = 0; k < v.data->wires.size(); ++k) all.append(WireView{v.data, k});
            return py::tuple(all);
        },
        "tuple of InstrumentOutput, in the order of World.instruments.");
    made_here_only(output);
}

}  // namespace seldinger::python
