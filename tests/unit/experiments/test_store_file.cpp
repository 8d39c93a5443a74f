// ensemble.h5: what is written is read again, by this program and by others, and damage is recognised.
#include <gtest/gtest.h>

#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>

#include "experiments/output/atomic_file.hpp"
#include "experiments/store/crc64.hpp"
#include "experiments/store/h5_file.hpp"
#include "tests/unit/experiments/store_helpers.hpp"

namespace loam::experiments {
namespace {

using namespace testing;

TEST(Crc64, GivesTheCatalogueCheckValue) {
    // CRC-64/XZ in G. Cook's catalogue of parametrised CRC algorithms: check = 0x995dc9bbdf1939fa.
    EXPECT_EQ(crc64("123456789"), 0x995dc9bbdf1939fau);
    EXPECT_EQ(crc64("6789", crc64("12345")), 0x995dc9bbdf1939fau);
}

TEST(EnsembleFile, IsReadAsItWasWritten) {
    EnsembleContents contents = toy_contents(40);
    contents.header.attributes["description"] = std::string(32000, 'x');
    contents.header.attributes["empty"] = "";
    contents.header.parameters[0].upper = std::numeric_limits<double>::infinity();
    contents.records[3].spec.index = 1'000'000'000'000'000'000u;
    std::swap(contents.records[3], contents.records.back());
    contents.records[6].diagnostics[1] = std::numeric_limits<double>::quiet_NaN();
    contents.records[6].reason = "a reason with a µ in it";
    const EnsembleContents read = decode_ensemble(encode_ensemble(contents), "ensemble.h5");
    EXPECT_TRUE(read.header == contents.header);
    expect_same(read.records, contents.records);
}

TEST(EnsembleFile, MayBeWithoutRunsAndWithoutDiagnostics) {
    EnsembleContents contents{toy_header(), {}};
    contents.header.diagnostics.clear();
    const EnsembleContents read = decode_ensemble(encode_ensemble(contents), "ensemble.h5");
    EXPECT_TRUE(read.header == contents.header);
    EXPECT_TRUE(read.records.empty());
}

TEST(EnsembleFile, AnyDamageIsRecognised) {
    const std::string bytes = encode_ensemble(toy_contents(5));
    for (std::size_t size = 0; size < bytes.size(); size += 1 + size / 40)
        EXPECT_NE(error_of([&] { decode_ensemble(bytes.substr(0, size), "e.h5"); }), "") << "cut at " << size;
    for (std::size_t at = 0; at < bytes.size(); at += 1 + at / 40) {
        std::string changed = bytes;
        changed[at] = static_cast<char>(changed[at] ^ 0x10);
        EXPECT_NE(error_of([&] { decode_ensemble(changed, "e.h5"); }), "") << "flipped at " << at;
    }
    EXPECT_NE(error_of([&] { decode_ensemble(bytes + "x", "e.h5"); }), "");
    const std::string text = error_of([&] { decode_ensemble(bytes.substr(0, 4000), "e.h5"); });
    EXPECT_NE(text.find("is damaged: cut short"), std::string::npos) << text;
    EXPECT_NE(text.find("put back a copy"), std::string::npos) << text;
}

TEST(EnsembleFile, OtherFilesAndOtherVersionsAreNamedAsSuch) {
    EXPECT_NE(error_of([] { decode_ensemble("", "e.h5"); }).find("is not an ensemble of this program"),
              std::string::npos);
    std::string bytes = encode_ensemble(toy_contents(2));
    bytes.replace(bytes.find("format 1"), 8, "format 7");
    const std::string text = error_of([&] { decode_ensemble(bytes, "e.h5"); });
    EXPECT_NE(text.find("format of another version of this program (7, this one's is 1)"), std::string::npos)
        << text;
}

/// The first 512 bytes that make any HDF5 image look like the store's own.
std::string with_valid_checksum(const std::string& image) {
    char line[160];
    std::snprintf(line, sizeof line, "loam ensemble, format 1\nHDF5 from byte 512 on, crc64-xz %016llx\n",
                  static_cast<unsigned long long>(crc64(image)));
    std::string block(line);
    block.resize(512, '\0');
    return block + image;
}

TEST(EnsembleFile, HDF5WithoutTheDataIsRefusedWithoutNoise) {
    const std::string image = encode_ensemble(toy_contents(5)).substr(512);
    ASSERT_EQ(error_of([&] { decode_ensemble(with_valid_checksum(image), "e.h5"); }), "");
    std::string renamed = image;
    renamed.replace(renamed.find("outputs"), 7, "outputz");
    ::testing::internal::CaptureStderr();
    const std::string text = error_of([&] { decode_ensemble(with_valid_checksum(renamed), "e.h5"); });
    const std::string not_hdf5 =
        error_of([&] { decode_ensemble(with_valid_checksum("no HDF5 at all"), "e.h5"); });
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
    EXPECT_NE(text.find("HDF5 failed at 'outputs'"), std::string::npos) << text;
    EXPECT_NE(not_hdf5, "");
}

TEST(EnsembleFile, IsReadableByH5pyWithoutThisProgram) {
    const TemporaryFolder folder;
    write_file_atomically(folder.path() / "ensemble.h5", encode_ensemble(toy_contents(9)));
    const std::string script = R"(
import h5py, json, math, sys
f = h5py.File(sys.argv[1], 'r')
text = lambda d: [s.decode() for s in d]
p, o = f['parameters'], f['outputs']
json.dump({
 'attributes': {k: (v.decode() if isinstance(v, bytes) else v if isinstance(v, str) else int(v)) for k, v in f.attrs.items()},
 'names': text(p.attrs['name']), 'units': text(p.attrs['unit']),
 'lower': list(p.attrs['lower']), 'upper': list(p.attrs['upper']),
 'row3': list(p[3]), 'out3': list(o[3]), 'failed_nan': all(math.isnan(v) for v in o[6]), 'shape': list(o.shape),
 'status': text(f['status'][:]), 'reason': f['reason'].asstr()[6], 'purpose': text(f['purpose'][:]),
 'index': f['index'][:].tolist(), 'seed3': int(f['packing_seed'][3]), 'particles': f['particles'][:].tolist(),
 'diagnostics': text(f['diagnostics'].attrs['name']), 'd3': list(f['diagnostics'][3]),
 'x': list(f['output_columns/x'][:]), 'channel': text(f['output_columns/channel'][:]),
 'file': text(f['output_columns/file'][:]), 'x_unit': text(f['output_columns/x_unit'][:])}, sys.stdout)
)";
    write_file_atomically(folder.path() / "read.py", script);
    const std::string out = folder.path() / "out.json";
    const std::string command = "/usr/bin/python3 " + (folder.path() / "read.py").string() + " " +
                                (folder.path() / "ensemble.h5").string() + " > " + out;
    ASSERT_EQ(std::system(command.c_str()), 0);
    const auto json = nlohmann::json::parse(read_whole_file(out));
    const auto list = [](const Eigen::VectorXd& v) { return std::vector<double>(v.begin(), v.end()); };
    const RunRecord third = toy_run(toy_spec(3));
    EXPECT_EQ(json["attributes"]["law"], "linear-cohesive");
    EXPECT_EQ(json["attributes"]["format"], "loam ensemble");
    EXPECT_EQ(json["attributes"]["campaign_seed"], 42);
    EXPECT_EQ(json["names"], (std::vector<std::string>{"young_modulus", "friction_angle"}));
    EXPECT_EQ(json["units"], (std::vector<std::string>{"Pa", "rad"}));
    EXPECT_EQ(json["lower"], (std::vector<double>{1e7, 0.05}));
    EXPECT_EQ(json["upper"], (std::vector<double>{1e10, 0.8}));
    EXPECT_EQ(json["row3"], list(third.spec.parameters));
    EXPECT_EQ(json["out3"], list(third.outputs));
    EXPECT_EQ(json["failed_nan"], true);
    EXPECT_EQ(json["shape"], (std::vector<int>{9, 3}));
    EXPECT_EQ(json["status"][5], "ok");
    EXPECT_EQ(json["status"][6], "failed");
    EXPECT_EQ(json["reason"], "not quasi-static: inertial number 0.02");
    EXPECT_EQ(json["purpose"][3], "replicate");
    EXPECT_EQ(json["index"], (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 8}));
    EXPECT_EQ(json["seed3"], 4000000028u);
    EXPECT_EQ(json["particles"][0], 700);
    EXPECT_EQ(json["diagnostics"], (std::vector<std::string>{"inertial_number_max", "porosity"}));
    EXPECT_EQ(json["d3"], (std::vector<double>{1e-4, 0.4}));
    EXPECT_EQ(json["x"], (std::vector<double>{1000, 2000, 3000}));
    EXPECT_EQ(json["channel"][2], "axial_strain");
    EXPECT_EQ(json["file"][0], "oedometer_1.csv");
    EXPECT_EQ(json["x_unit"][0], "Pa");
}

TEST(Header, MistakesAreRefused) {
    const auto refused = [](const std::function<void(EnsembleHeader&)>& change) {
        EnsembleHeader header = toy_header();
        change(header);
        EXPECT_THROW(validate(header), std::invalid_argument);
    };
    EXPECT_NO_THROW(validate(toy_header()));
    refused([](auto& h) { h.parameters.clear(); });
    refused([](auto& h) { h.outputs.clear(); });
    refused([](auto& h) { h.parameters[1].name = h.parameters[0].name; });
    refused([](auto& h) { h.parameters[1].name = ""; });
    refused([](auto& h) { h.parameters[1].lower = std::nan(""); });
    refused([](auto& h) { h.outputs[1].x = std::nan(""); });
    refused([](auto& h) { h.outputs[1].channel = ""; });
    refused([](auto& h) { h.diagnostics[1].unit = std::string("a\0b", 3); });
    refused([](auto& h) { h.attributes["long"] = std::string(32001, 'x'); });
    refused([](auto& h) { h.attributes["format"] = "mine"; });
}

TEST(Header, EveryDifferenceIsSeenByWordsAndFingerprint) {
    const EnsembleHeader base = toy_header();
    EXPECT_TRUE(differences(base, base).empty());
    const auto expect_seen = [&](const std::string& word,
                                 const std::function<void(EnsembleHeader&)>& change) {
        EnsembleHeader other = base;
        change(other);
        const auto found = differences(base, other);
        ASSERT_EQ(found.size(), 1u) << word;
        EXPECT_NE(found[0].find(word), std::string::npos) << found[0];
        EXPECT_NE(fingerprint(base), fingerprint(other)) << word;
    };
    expect_seen("the campaign seed is 42 there and 43 here", [](auto& h) { h.campaign_seed = 43; });
    expect_seen("there are 2 parameters there and 1 here", [](auto& h) { h.parameters.pop_back(); });
    expect_seen("friction_angle from 0.05 to 0.9 rad", [](auto& h) { h.parameters[1].upper = 0.9; });
    expect_seen("young_modulus", [](auto& h) { h.parameters[0].unit = "kPa"; });
    expect_seen("triaxial.csv", [](auto& h) { h.outputs[2].file = "triaxial.csv"; });
    expect_seen("= 5", [](auto& h) { h.outputs[2].x = 5; });
    expect_seen("porosity", [](auto& h) { h.diagnostics[1].name = "void_ratio"; });
    expect_seen("'law' is 'linear-cohesive' there and 'linear-damped' here",
                [](auto& h) { h.attributes["law"] = "linear-damped"; });
    expect_seen("'effects' is not set there", [](auto& h) { h.attributes["effects"] = "creep"; });
}

}  // namespace
}  // namespace loam::experiments
