#include "app/compare/ComparePage.h"

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <string_view>

#include "app/report/Table.h"

namespace app {

namespace embedded {
extern const std::string_view page, style, script, charts;
}

namespace {

std::string escaped(std::string_view text) {
    std::string out;
    for (const char c : text) switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            case '\'':
                out += "&#39;";
                break;
            default:
                out += c;
        }
    return out;
}

std::string cell(double value, int decimals) {
    const std::string text = fixed(value, decimals);
    return "<td data-v=\"" + (std::isfinite(value) ? fixed(value, 6) : std::string("")) + "\">" +
           (text == "-" ? "&ndash;" : text) + "</td>";
}

std::string viewsName(const std::string& views) {
    return views == "eyes" ? "two eyes" : views == "four" ? "four displays" : "one";
}

std::string tableRow(const CompareRow& row) {
    const PictureErrors& e = row.againstTruth;
    std::string html = "<tr data-method=\"" + escaped(row.point.title()) + "\"" +
                       (row.onFront           ? " class=\"front\""
                        : row.point.isDefault ? " class=\"default\""
                                              : "") +
                       "><td><i class=\"key\" data-method=\"" + escaped(row.point.title()) + "\"></i>" +
                       escaped(row.point.title()) + "</td><td class=\"text\">" + escaped(row.point.setting) +
                       "</td>";
    html += "<td>" + std::to_string(row.cars) + "</td><td class=\"text\">" + viewsName(row.views) + "</td>";
    html += cell(row.frame.median, 1) + cell(row.reflection.median, 2) + cell(row.ratioToNone, 2);
    html += cell(e.flip, 4) + cell(row.againstRerender.flip, 4) + cell(e.hdrFlip, 4) + cell(e.psnr, 1) +
            cell(e.ssim, 3) + cell(1000 * e.flicker, 2) + cell(glm::degrees(e.angle), 1) +
            cell(row.mapsPerFrame, 1);
    html += std::string("<td class=\"mark\">") + (row.onFront ? "&#9679;" : "") + "</td></tr>\n";
    return html;
}

std::string tableRows(const std::vector<CompareRow>& rows) {
    std::string html;
    for (const CompareRow& row : rows) html += tableRow(row);
    return html;
}

std::string factList(const PageHead& head, const std::vector<CompareRow>& rows) {
    std::string size = "&ndash;";
    if (!rows.empty())
        size = std::to_string(rows.front().width) + " &times; " + std::to_string(rows.front().height);
    const auto fact = [](const std::string& name, const std::string& value) {
        return "<div><dt>" + name + "</dt><dd>" + value + "</dd></div>\n";
    };
    return fact("City", escaped(head.city)) + fact("Seed", std::to_string(head.seed)) +
           fact("Pictures", size + ", " + std::to_string(head.frames) + " frames each") +
           fact("Processor", escaped(head.cpu) + ", " + std::to_string(head.threads) + " threads") +
           fact("OpenGL", escaped(head.renderer)) + fact("Errors against", escaped(head.truth)) +
           fact("Program", "mirrorstreet " + escaped(head.version));
}

/// A row for each other method, a column for each number of cars.
std::string verdictTable(const std::vector<CompareRow>& rows) {
    const std::vector<FrontVerdict> verdicts = frontVerdicts(rows);
    std::vector<std::uint32_t> cars;
    std::vector<std::string> others;
    for (const FrontVerdict& v : verdicts) {
        if (std::find(cars.begin(), cars.end(), v.cars) == cars.end()) cars.push_back(v.cars);
        if (std::find(others.begin(), others.end(), v.other) == others.end()) others.push_back(v.other);
    }
    std::string html = "<table><thead><tr><th class=\"text\">beside</th>";
    for (const std::uint32_t count : cars)
        html += "<th class=\"text\">" + std::to_string(count) + (count == 1 ? " car" : " cars") + "</th>";
    html += "</tr></thead><tbody>\n";
    for (const std::string& other : others) {
        html +=
            "<tr><td><i class=\"key\" data-method=\"" + escaped(other) + "\"></i>" + escaped(other) + "</td>";
        for (const std::uint32_t count : cars) {
            const auto v = std::find_if(verdicts.begin(), verdicts.end(), [&](const FrontVerdict& x) {
                return x.cars == count && x.other == other;
            });
            const bool none = v == verdicts.end() || v->points == 0;
            const bool whole = !none && v->below == v->points;
            html += std::string("<td class=\"") +
                    (none    ? "open"
                     : whole ? "yes"
                             : "no") +
                    "\">" +
                    (none    ? "outside"
                     : whole ? "below at all " + std::to_string(v->points)
                             : "below at " + std::to_string(v->below) + " of " + std::to_string(v->points)) +
                    "</td>";
        }
        html += "</tr>\n";
    }
    return html + "</tbody></table>\n";
}

std::string picture(const std::string& kind, const Picture& p, const std::string& alt) {
    return "<img class=\"" + kind + "\" src=\"" + dataUrl(p, PictureFormat::jpeg) + "\" width=\"" +
           std::to_string(p.width) + "\" height=\"" + std::to_string(p.height) + "\" alt=\"" + escaped(alt) +
           "\">";
}

/// Every picture is in the page once: on screen a viewer shows one method at a time, paper shows all.
std::string stripSection(const PictureStrip& strip) {
    const std::string cars = std::to_string(strip.cars) + (strip.cars == 1 ? " car" : " cars");
    const std::string title = strip.title.empty() ? cars + " on screen" : escaped(strip.title);
    std::string html = "<section class=\"strip\"><h3>" + title + "</h3>\n<div class=\"tabs\"></div>\n";
    html += "<div class=\"frames\">\n<figure class=\"reference\">" +
            picture("truth", strip.truth, "truth, " + cars) +
            "<figcaption><b>truth</b></figcaption></figure>\n";
    for (const PictureStrip::Frame& frame : strip.frames)
        html += "<figure data-method=\"" + escaped(frame.title) + "\">" +
                picture("method", frame.picture, frame.title + ", " + cars) +
                picture("difference", frame.difference, "difference of " + frame.title + " from the truth") +
                "<figcaption><i class=\"key\" data-method=\"" + escaped(frame.title) + "\"></i><b>" +
                escaped(frame.title) + "</b> " + escaped(frame.setting) + ": mean FLIP " +
                fixed(frame.flip, 4) + "</figcaption></figure>\n";
    return html + "</div></section>\n";
}

/// All of the page that is about windows; nothing without any.
std::string windowsSection(const WindowComparison& windows) {
    if (windows.rows.empty()) return "";
    std::string html =
        "<section id=\"windows\">\n<h2>Windows that mirror</h2>\n"
        "<p class=\"note\">Shop fronts and curtain walls of a street, drawn with so many mirrors in a row "
        "and at most so many "
        "reflections a frame; errors are over the pixels of glass, against ray traced glass, four mirrors in "
        "a row.</p>\n"
        "<div class=\"pair\">\n"
        "<figure><div class=\"canvas\"><canvas id=\"windows-cost\"></canvas></div><figcaption>Time of a "
        "frame, of the same with "
        "painted windows, against the reflections drawn.</figcaption></figure>\n"
        "<figure><div class=\"canvas\"><canvas id=\"windows-error\"></canvas></div><figcaption>Error of the "
        "glass against that "
        "time.</figcaption></figure>\n"
        "<figure><div class=\"canvas\"><canvas id=\"windows-count\"></canvas></div><figcaption>The same time "
        "where "
        "most fronts of the city are in view, against how many of them "
        "mirror.</figcaption></figure>\n</div>\n";
    for (const PictureStrip& strip : windows.strips) html += stripSection(strip);
    html +=
        "<div class=\"scroll\"><table><thead><tr><th class=\"text\">windows</th><th>mirrors in a "
        "row</th><th>maps at "
        "most</th><th>in "
        "view</th><th>mirror</th><th>panes</th><th>passes</th><th>levels</th><th>Mtexels</th><th>MiB of "
        "maps</th><th>frame ms</th><th>of painted</th><th>PSNR dB</th><th>FLIP</th></tr></thead><tbody>\n";
    for (const WindowRow& row : windows.rows) {
        html += "<tr data-windows=\"" + escaped(row.name) + "\"><td class=\"text\">" + escaped(row.name) +
                "</td>";
        for (const std::uint64_t count :
             {static_cast<std::uint64_t>(row.depth), std::uint64_t{row.mostMaps}, std::uint64_t{row.inView},
              std::uint64_t{row.fronts}, std::uint64_t{row.panes}, std::uint64_t{row.passes},
              std::uint64_t{row.levels}})
            html += "<td>" + std::to_string(count) + "</td>";
        html += cell(static_cast<double>(row.texels) / 1e6, 2) +
                cell(static_cast<double>(row.textureBytes) / 1048576, 1) + cell(row.frame.median, 1) +
                cell(row.ratioToPainted, 2) + cell(row.psnr, 1) + cell(row.flip, 4) + "</tr>\n";
    }
    return html + "</tbody></table></div>\n</section>\n";
}

/// Close-ups of chrome; nothing without any.
std::string chromeSection(const ChromeComparison& chrome) {
    if (chrome.rows.empty()) return "";
    std::string html =
        "<section id=\"chrome\">\n<h2>Close chrome</h2>\n"
        "<p class=\"note\">Things that mirror, with others a hand&rsquo;s breadth to a metre away. "
        "<b>chrome</b> shows what is close where it truly appears, and the local map of <b>mem</b> beyond; "
        "errors are over the pixels of the chrome, against the truth.</p>\n";
    for (const PictureStrip& strip : chrome.strips) html += stripSection(strip);
    html +=
        "<div class=\"scroll\"><table><thead><tr><th class=\"text\">view</th><th "
        "class=\"text\">method</th><th>parts</th><th>pixels</th><th>frame ms</th><th>of none</th><th>PSNR "
        "dB</th><th>FLIP</th></tr></thead><tbody>\n";
    for (const ChromeRow& row : chrome.rows)
        html += "<tr data-chrome=\"" + escaped(row.view) + "\"><td class=\"text\">" + escaped(row.view) +
                "</td><td class=\"text\">" + escaped(row.method) + "</td><td>" + std::to_string(row.jobs) +
                "</td><td>" + std::to_string(row.pixels) + "</td>" + cell(row.frame.median, 1) +
                cell(row.ratioToNone, 2) + cell(row.psnr, 1) + cell(row.flip, 4) + "</tr>\n";
    return html + "</tbody></table></div>\n</section>\n";
}

/// JSON within a script element: nothing in it may end that element.
std::string scriptJson(const nlohmann::ordered_json& json) {
    std::string out;
    for (const char c : json.dump()) out += c == '<' ? "\\u003c" : std::string(1, c);
    return out;
}

void put(std::string& page, const std::string& mark, std::string_view text) {
    const std::size_t at = page.find(mark);
    if (at != std::string::npos) page.replace(at, mark.size(), text);
}

}  // namespace

std::string comparePage(const PageHead& head, const std::vector<CompareRow>& rows,
                        const std::vector<PictureStrip>& strips, const WindowComparison& windows,
                        const ChromeComparison& chrome) {
    nlohmann::ordered_json data = nlohmann::ordered_json::array();
    for (const CompareRow& row : rows) {
        nlohmann::ordered_json json = toJson(row, head.city);
        json["title"] = row.point.title();
        data.push_back(std::move(json));
    }
    nlohmann::ordered_json windowData = nlohmann::ordered_json::array();
    for (const WindowRow& row : windows.rows) windowData.push_back(toJson(row, head.city));
    std::string stripsHtml;
    for (const PictureStrip& strip : strips) stripsHtml += stripSection(strip);
    // Marks from the end to the start, so that no text put in is searched for further marks.
    std::string page(embedded::page);
    put(page, "@SCRIPT@", embedded::script);
    put(page, "@WINDOW_DATA@", scriptJson(windowData));
    put(page, "@DATA@", scriptJson(data));
    put(page, "@CHARTS@", embedded::charts);
    put(page, "@ROWS@", tableRows(rows));
    put(page, "@WINDOWS@", windowsSection(windows) + chromeSection(chrome));
    put(page, "@STRIPS@", stripsHtml);
    put(page, "@VERDICTS@", verdictTable(rows));
    put(page, "@FACTS@", factList(head, rows));
    put(page, "@PARTIAL@",
        head.partial
            ? "<p class=\"partial\">Partial: the measurement was interrupted; what was finished is here.</p>"
            : "");
    put(page, "@STYLE@", embedded::style);
    put(page, "@TITLE@", escaped("Reflections in " + head.city + ": error against cost"));
    return page;
}

}  // namespace app
