// Rows of the traces, and the tables of a run's last state.
#include "record/recorder.h"
#include "run/frames.h"
#include "setup/joint_readings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace seldinger {
namespace {

constexpr std::string_view trace_columns =
    "step,time_s,inserted_m,turned_rad,nodes,contacts,normal_n,friction_n,sliding_n,static_n,rolling_nm,hand_force_n,hand_torque_"
    "nm,"
    "overlap_m,newton,step_ms,contact_length_m,outside_m,base_force_x_n,base_force_y_n,base_force_z_n,kinetic_j,elastic_j,"
    "gravitational_j,flags,momentum_error_n,tip_x_m,tip_y_m,tip_z_m,wall_move_max_m,wall_energy_j,wall_loss_j,wall_stress_max_"
    "pa,contact_area_m2,contact_pressure_max_pa,force_per_length_max_n_per_m,force_per_length_at_m,patch_force_max_n,contact_"
    "regions,contact_extent_m,instruments_force_per_length_max_n_per_m";

/// The columns above, and those of the ledger.
std::string trace_header()
{
    std::string header(trace_columns);
    for (const EnergyEntry& entry : energy_entries({})) header.append(",").append(entry.name);
    return header + "\n";
}

}  // namespace

std::string Recorder::csv(double value)
{
    if (std::isfinite(value)) return fmt::format("{}", value);  // the shortest text that reads back to the same bits
    tally_.non_finite++;
    return {};
}

/// Opens trace.csv and each instrument's and sensor's, new or cut to what a checkpoint has seen.
void Recorder::begin_traces(const World& world, const std::vector<std::uint64_t>& kept)
{
    std::vector<std::string> names = {"trace.csv"}, headers;
    for (int k = 0; k < scene_.instrument_count(); ++k)
        if (const std::string& label = scene_.instrument(k).label; !label.empty()) names.push_back("trace_" + label + ".csv");
    headers.assign(names.size(), trace_header());
    for (const WireOutput& wire : world.output(Output::Numbers).wires)
        for (const SensorOutput& sensor : wire.sensors) {
            std::string stem = "sensor_" + sensor.name.substr(0, 64);
            std::ranges::replace_if(stem, [](unsigned char c) { return !std::isalnum(c) && c != '-'; }, '_');
            while (std::ranges::count(names, stem + ".csv") > 0) stem += "_2";
            names.push_back(stem + ".csv");
            headers.push_back(fmt::format("{}\n", fmt::join(sensor.columns, ",")));
            sensed_.push_back(sensor.values[0]);
        }
    for (std::size_t k = 0; k < names.size(); ++k) {
        traces_.emplace_back(dir_ / names[k], k < kept.size() ? kept[k] : 0);
        if (k >= kept.size()) traces_.back().append(headers[k]);
    }
}

void Recorder::write_samples(const Output& now)
{
    std::size_t k = 0;
    for (const WireOutput& wire : now.wires)
        for (const SensorOutput& sensor : wire.sensors) {
            if (k == sensed_.size()) return;  // given to the world after the run had begun
            if (sensor.values[0] != sensed_[k])
                traces_[traces_.size() - sensed_.size() + k].append(fmt::format("{}\n", fmt::join(sensor.values, ",")));
            sensed_[k++] = sensor.values[0];
        }
}

void Recorder::write_row(const Output& now)
{
    double area = 0, pressure = 0;
    for (const WireOutput& wire : now.wires) {
        area += wire.contact_area;
        pressure = std::max(pressure, wire.contact_pressure_max);
    }
    tally_.contact_area_max = std::max(tally_.contact_area_max, area);
    tally_.contact_pressure_max = std::max(tally_.contact_pressure_max, pressure);
    const ContactAlong wall = joint_along(now.wires, &WireOutput::on_wall);
    const ContactAlong instruments = joint_along(now.wires, &WireOutput::on_instruments);
    traces_[0].append(row_of(readings_, now.wires[0], now, patch_fields(area, pressure) + along_fields(wall, instruments)));
    for (std::size_t k = 1; k < traces_.size() - sensed_.size(); ++k) {
        const WireOutput& wire = now.wires[k - 1];
        const std::string contact = patch_fields(wire.contact_area, wire.contact_pressure_max);
        traces_[k].append(row_of(wire.readings, wire, now, contact + along_fields(wire.on_wall, wire.on_instruments)));
    }
    tally_.row_newton = tally_.row_flags = tally_.row_steps = 0;
    tally_.row_time = 0;
}

/// @param wire  whose tip it is   @param contact  its fields
std::string Recorder::row_of(const WireReadings& r, const WireOutput& wire, const Output& now, const std::string& contact)
{
    const double step_ms = tally_.row_steps > 0 ? 1e3 * tally_.row_time / static_cast<double>(tally_.row_steps) : 0;
    std::string row =
        fmt::format("{},{},{},{},{},{}", tally_.steps, csv(now.time), csv(r.inserted), csv(r.turned), r.nodes, r.contacts);
    for (const double v : {r.normal, r.friction, r.sliding, r.sticking, r.rolling, r.hand_force, r.hand_torque, r.overlap})
        row += "," + csv(v);
    row += fmt::format(",{},{:.4g}", tally_.row_newton, step_ms);
    for (const double v : {r.contact_length, r.outside, r.base_force.x(), r.base_force.y(), r.base_force.z(), r.kinetic,
                           r.elastic, r.gravitational})
        row += "," + csv(v);
    return row +
           fmt::format(",{},{},{},{},{}", tally_.row_flags, csv(r.momentum.error().norm()), csv(wire.tip.x()), csv(wire.tip.y()),
                       csv(wire.tip.z())) +
           wall_fields(now) + contact + energy_fields(r.energy) + "\n";
}

std::string Recorder::wall_fields(const Output& now)
{
    const WallReadings w = now.walls.empty() ? WallReadings{} : now.walls[0].readings;
    return fmt::format(",{},{},{},{}", csv(w.move_max), csv(w.energy), csv(w.loss), csv(w.stress_max));
}

std::string Recorder::energy_fields(const EnergyLedger& ledger)
{
    std::string fields;
    for (const EnergyEntry& entry : energy_entries(ledger)) fields += "," + csv(entry.value);
    return fields;
}

std::string Recorder::patch_fields(double area, double pressure) { return fmt::format(",{},{}", csv(area), csv(pressure)); }

std::string Recorder::along_fields(const ContactAlong& wall, const ContactAlong& instruments)
{
    return fmt::format(",{},{},{},{},{},{}", csv(wall.per_length_max), csv(wall.per_length_at), csv(wall.patch_force),
                       wall.regions, csv(wall.extent), csv(instruments.per_length_max));
}

void Recorder::write_wire_table(const WireOutput& wire, const std::string& name)
{
    std::string table = "s_m,x_m,y_m,z_m,vx,vy,vz,spin_rad,fx_n,fy_n,fz_n\n";
    for (std::size_t i = 0; i < wire.position.size(); ++i) {
        const Vec3 &f = wire.contact_force[i], &x = wire.position[i], &v = wire.velocity[i];
        const double row[] = {wire.material_s[i], x.x(), x.y(), x.z(), v.x(), v.y(), v.z(), wire.spin[i], f.x(), f.y(), f.z()};
        for (const double& value : row) table += csv(value) + (&value == std::end(row) - 1 ? "\n" : ",");
    }
    write_file(dir_ / (name + ".csv"), table);
}

void Recorder::write_contact_table(const Output& now)
{
    std::string table =
        "edge,triangle,x_m,y_m,z_m,nx,ny,nz,gap_m,normal_n,friction_n,stuck,rolling_nm,length_m,area_m2,pressure_pa,body_a,body_"
        "b,s_a_m,s_b_m,force_per_length_n_per_m,region\n";
    const auto name_of = [&](const ContactSide& side) {
        return side.kind == BodyKind::Wall ? std::string("wall") : series_of(scene_, side.body);
    };
    for (const ContactRow& c : now.contacts) {
        table += fmt::format("{},{}", c.a.element, c.b.element);
        for (const double v : {c.point.x(), c.point.y(), c.point.z(), c.normal.x(), c.normal.y(), c.normal.z(), c.gap,
                               c.normal_force, c.friction.norm()})
            table += "," + csv(v);
        table += fmt::format(",{},{},{},{},{},{},{}", c.stuck ? 1 : 0, csv(c.rolling_moment), csv(c.length), csv(c.area),
                             csv(c.pressure), name_of(c.a), name_of(c.b));
        table += fmt::format(",{},{},{},{}\n", csv(c.along_a), c.b.kind == BodyKind::Wall ? "" : csv(c.along_b),
                             csv(c.per_length), c.region);
    }
    write_file(dir_ / "contacts.csv", table);
}

}  // namespace seldinger
