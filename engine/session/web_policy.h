#pragma once
// Who may talk to the session's web server, decided from text alone: token, origin, host, and how much a client may send.

#include <string>
#include <string_view>

namespace seldinger {

/// Whether an address is this machine's own.
[[nodiscard]] bool is_loopback(std::string_view address);

/// The same, in a time that does not tell where they differ.
[[nodiscard]] bool same_secret(std::string_view a, std::string_view b);

/// Value of `name` in a query ("/?token=x&y=z") or a cookie ("a=b; token=x"); empty where it is not.
[[nodiscard]] std::string query_value(std::string_view target, std::string_view name);
[[nodiscard]] std::string cookie_value(std::string_view cookies, std::string_view name);

/// What a request says of itself.
struct WebRequest {
    std::string_view target, host, origin, cookie;
};

enum class Admission { Welcome, WrongHost, WrongOrigin, WrongToken };

/// A page of another site that a browser shows may neither open the socket (its Origin is not ours) nor have its own name point here (its
/// Host is not ours) [RFC 6455, sec. 10.2]. Programs send no Origin, and need the token like anyone where there is one.
[[nodiscard]] Admission admit(const WebRequest& request, std::string_view bound_to, std::string_view token);

/// So many messages a second, with as many at once: an allowance that fills with time.
class RateLimit {
public:
    explicit RateLimit(double per_second) : per_second_(per_second), left_(per_second) {}
    /// @param now  [s], rising
    bool allow(double now)
    {
        left_ = left_ + per_second_ * (now - last_) < per_second_ ? left_ + per_second_ * (now - last_) : per_second_;
        last_ = now;
        if (left_ < 1) return false;
        left_ -= 1;
        return true;
    }

private:
    double per_second_, left_, last_ = 0;
};

}  // namespace seldinger
