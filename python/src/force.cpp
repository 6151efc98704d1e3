// Python's forces behind the engine's door (solve/force.h): arrays that are filled, asked, and read again.
#include "force.h"

#include <algorithm>

namespace seldinger::python {

namespace {

using Array = py::array_t<double, py::array::c_style>;
using Numbers = py::array_t<int, py::array::c_style>;

thread_local const Handle* asking = nullptr;  // whose force is being called

/// A force written in Python. Its arrays are made anew where the number of points changes: holders keep theirs.
class PythonForce final : public Force {
public:
    PythonForce(const Handle& handle, py::object own, const py::dict& about) : handle_(handle), own_(std::move(own))
    {
        name = about["name"].cast<std::string>();
        on = static_cast<On>(about["on"].cast<int>());
        places = about["places"].cast<std::vector<double>>();
        state = about["state"].cast<std::vector<double>>();
        each_trial = about["each_trial"].cast<bool>();
        together = about["together"].cast<bool>();
        record = about["record"].cast<std::vector<std::string>>();
        has_ = about["has"].cast<std::array<bool, 3>>();
    }
    ~PythonForce() override
    {
        const py::gil_scoped_acquire lock;
        for (Array* array : arrays()) array->release().dec_ref();
        wire_.release().dec_ref();
        seen_.release().dec_ref();
        own_.release().dec_ref();
    }
    PythonForce(const PythonForce&) = delete;
    PythonForce& operator=(const PythonForce&) = delete;

    void forces(const ForcePoints& at, std::span<PointForce> out) const override
    {
        const py::gil_scoped_acquire lock;
        show(at);
        std::fill_n(force_.mutable_data(), force_.size(), 0.0);
        std::fill_n(moment_.mutable_data(), moment_.size(), 0.0);
        call("_forces");
        for (std::size_t k = 0; k < out.size(); ++k) out[k] = {Vec3(force_.data() + 3 * k), Vec3(moment_.data() + 3 * k)};
    }
    bool tangents(const ForcePoints&, std::span<PointTangent> out) const override  // after forces(), of the same points
    {
        if (!has_[0]) return false;
        const py::gil_scoped_acquire lock;
        for (Array* array : {&tangent_, &damping_}) std::fill_n(array->mutable_data(), array->size(), 0.0);
        call("tangents");
        for (std::size_t k = 0; k < out.size(); ++k) {
            std::copy_n(tangent_.data() + 36 * k, 36, out[k].stiffness.front().data());
            std::copy_n(damping_.data() + 36 * k, 36, out[k].damping.front().data());
        }
        return true;
    }
    double energy(const ForcePoints& at) const override
    {
        if (!has_[1]) return 0;
        const py::gil_scoped_acquire lock;
        show(at);
        return call("energy").cast<double>();
    }
    void accept(const ForcePoints& at, std::span<double> next) const override
    {
        if (!has_[2]) return;
        const py::gil_scoped_acquire lock;
        show(at);
        state_.attr("setflags")(py::arg("write") = true);
        call("accept");
        state_.attr("setflags")(py::arg("write") = false);
        std::copy_n(state_.data(), next.size(), next.begin());
    }

private:
    std::array<Array*, 12> arrays() const
    {
        return {&s_,       &length_, &position_, &velocity_, &axis_,    &director_,
                &turning_, &state_,  &force_,    &moment_,   &tangent_, &damping_};
    }

    void make(py::ssize_t count) const
    {
        const py::ssize_t three = 3, six = 6;
        wire_ = Numbers(count);
        wire_.attr("setflags")(py::arg("write") = false);
        for (Array* array : {&s_, &length_}) *array = Array(count);
        for (Array* array : {&position_, &velocity_, &axis_, &director_, &turning_, &force_, &moment_})
            *array = Array({count, three});
        for (Array* array : {&tangent_, &damping_}) *array = Array({count, six, six});
        state_ = Array(static_cast<py::ssize_t>(state.size()));
        for (Array* array : {&s_, &length_, &position_, &velocity_, &axis_, &director_, &turning_, &state_})
            array->attr("setflags")(py::arg("write") = false);
        seen_ = py::module_::import("seldinger._force")
                    .attr("Points")(wire_, s_, length_, position_, velocity_, axis_, director_, turning_, state_, force_,
                                    moment_, tangent_, damping_);
    }

    void show(const ForcePoints& at) const
    {
        const auto fill = [](const auto& to, auto from) {
            using Value = std::remove_cvref_t<decltype(*to.data())>;
            std::copy_n(reinterpret_cast<const Value*>(from.data()), to.size(), const_cast<Value*>(to.data()));
        };
        if (!seen_ || s_.size() != static_cast<py::ssize_t>(at.s.size())) make(static_cast<py::ssize_t>(at.s.size()));
        fill(wire_, at.wire), fill(s_, at.s), fill(length_, at.length);
        fill(position_, at.position), fill(velocity_, at.velocity);
        fill(axis_, at.axis), fill(director_, at.director), fill(turning_, at.turning), fill(state_, at.state);
        seen_.attr("time") = at.time;
        seen_.attr("dt") = at.dt;
    }

    py::object call(const char* method) const
    {
        const Handle* before = asking;
        asking = &handle_;
        try {
            py::object result = own_.attr(method)(seen_);
            asking = before;
            return result;
        } catch (...) {
            asking = before;
            throw;
        }
    }

    const Handle& handle_;
    mutable py::object own_, seen_;
    std::array<bool, 3> has_{};  // tangents, energy, accept
    mutable Numbers wire_;
    mutable Array s_, length_, position_, velocity_, axis_, director_, turning_, state_, force_, moment_, tangent_, damping_;
};

}  // namespace

const Handle* asking_handle() { return asking; }

std::shared_ptr<const Force> python_force(const Handle& handle, const py::object& own, const py::dict& about)
{
    return std::make_shared<PythonForce>(handle, own, about);
}

}  // namespace seldinger::python
