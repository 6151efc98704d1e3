// Saved state of the watch over a wire's energy.

#include "core/bytes.h"
#include "core/error.h"
#include "world/energy_audit.h"

namespace seldinger {

namespace {

void put_list(std::vector<std::uint8_t>& bytes, const std::vector<double>& list)
{
    const std::int32_t count = static_cast<std::int32_t>(list.size());
    put_bytes(bytes, &count, 1);
    put_bytes(bytes, list.data(), list.size());
}

void take_list(const std::uint8_t*& bytes, const std::uint8_t* end, std::vector<double>& list)
{
    std::int32_t count = 0;
    take_bytes(bytes, end, &count, 1);
    if (count < 0 || static_cast<std::size_t>(count) * sizeof(double) > static_cast<std::size_t>(end - bytes))
        throw Error(ExitCode::BadFile, "a list of the saved state is longer than the file");
    list.resize(static_cast<std::size_t>(count));
    take_bytes(bytes, end, list.data(), list.size());
}

}  // namespace

void put_audit(std::vector<std::uint8_t>& bytes, const EnergyAudit& audit)
{
    const std::uint8_t known = audit.known;
    put_bytes(bytes, &known, 1);
    put_bytes(bytes, &audit.balance, 1);
    put_bytes(bytes, &audit.ledger, 1);
    put_bytes(bytes, &audit.wire_then, 1);
    put_bytes(bytes, &audit.elastic_then, 1);
    put_bytes(bytes, &audit.moving, 1);
    put_bytes(bytes, &audit.remeshed, 1);
    put_bytes(bytes, &audit.hand_force, 1);
    put_bytes(bytes, &audit.speed, 1);
    for (const auto* list : {&audit.held, &audit.held_speed, &audit.torque, &audit.turns}) put_list(bytes, *list);
}

void take_audit(const std::uint8_t*& bytes, const std::uint8_t* end, EnergyAudit& audit)
{
    std::uint8_t known = 0;
    take_bytes(bytes, end, &known, 1);
    audit.known = known != 0;
    take_bytes(bytes, end, &audit.balance, 1);
    take_bytes(bytes, end, &audit.ledger, 1);
    take_bytes(bytes, end, &audit.wire_then, 1);
    take_bytes(bytes, end, &audit.elastic_then, 1);
    take_bytes(bytes, end, &audit.moving, 1);
    take_bytes(bytes, end, &audit.remeshed, 1);
    take_bytes(bytes, end, &audit.hand_force, 1);
    take_bytes(bytes, end, &audit.speed, 1);
    for (auto* list : {&audit.held, &audit.held_speed, &audit.torque, &audit.turns}) take_list(bytes, end, *list);
}

}  // namespace seldinger
