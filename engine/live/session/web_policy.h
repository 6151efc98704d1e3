#pragma once
// Access to the session's web server, decided from text alone: token, origin, host, and limits for a client.

#include <map>
#include <string>
#include <string_view>

namespace seldinger {

/// Whether an address is this machine's own.
[[nodiscard]] bool is_loopback(std::string_view address);

/// The same, in a time that does not tell where they differ.
[[nodiscard]] bool same_secret(std::string_view a, std::string_view b);

/// What a token may be: what an address and a cookie carry as it is (RFC 3986, 2.3), and too much of it to be guessed.
inline constexpr std::size_t least_token = 16;
[[nodiscard]] bool is_token(std::string_view text);
/// 128 random bits of the system's, as 32 digits. @throws Error BadFile: the system has none
[[nodiscard]] std::string make_token();

/// Value of `name` in a query ("/?token=x&y=z") or a cookie ("a=b; token=x"); empty where it is not.
[[nodiscard]] std::string query_value(std::string_view target, std::string_view name);
[[nodiscard]] std::string cookie_value(std::string_view cookies, std::string_view name);

/// What a request says of itself.
struct WebRequest {
    std::string_view target, host, origin, cookie;
};

enum class Admission { Welcome, WrongHost, WrongOrigin, WrongToken };

/// A page of another site may neither open the socket (its Origin is not ours) nor have its own name point here (its Host is
/// not ours) [RFC 6455, sec. 10.2]. Programs send no Origin, and need the token like anyone where there is one.
[[nodiscard]] Admission admit(const WebRequest& request, std::string_view bound_to, std::string_view token);

/// How an address is written in a URL: one of version 6 in brackets.
[[nodiscard]] std::string in_url(const std::string& address);

/// So many of anything a second, with so many at once: an allowance that fills with time.
class RateLimit {
public:
    explicit RateLimit(double per_second) : RateLimit(per_second, per_second, 0) {}
    RateLimit(double per_second, double at_once, double now)
        : per_second_(per_second), at_once_(at_once), left_(at_once), last_(now)
    {
    }
    /// @param now  [s], rising
    bool allow(double now)
    {
        if (!is_left(now)) return false;
        left_ -= 1;
        return true;
    }
    /// Whether allow() would, without taking anything.
    bool is_left(double now)
    {
        left_ = left_ + per_second_ * (now - last_) < at_once_ ? left_ + per_second_ * (now - last_) : at_once_;
        last_ = now;
        return left_ >= 1;
    }
    [[nodiscard]] double last() const { return last_; }  // [s]

private:
    double per_second_, at_once_, left_, last_;
};

/// Wrong tokens by the address that they came from. An address with too many wrong tokens waits before the next one is checked.
class WrongTokens {
public:
    static constexpr double per_second = 5, at_once = 20;  // a page of an earlier session asks once a second
    static constexpr std::size_t most_addresses = 1024;    // remembered; the one that was heard of longest ago is forgotten

    /// @param now  [s], rising
    [[nodiscard]] bool may_try(const std::string& address, double now);
    void count(const std::string& address, double now);

private:
    std::map<std::string, RateLimit> of_;
};

}  // namespace seldinger
