// Source: Microsoft's reference of the Windows API.
#include <windows.h>

#include <psapi.h>

#include <algorithm>

#include "core/memory_budget.h"

namespace cloudbake {

namespace {

// Of the job that this process belongs to, if it has one: containers are jobs.
uint64_t limitOfJob() {
  JOBOBJECT_EXTENDED_LIMIT_INFORMATION job{};
  if (!::QueryInformationJobObject(nullptr, JobObjectExtendedLimitInformation, &job, sizeof job, nullptr)) return kNoMemoryLimit;
  const DWORD flags = job.BasicLimitInformation.LimitFlags;
  return std::min(flags & JOB_OBJECT_LIMIT_PROCESS_MEMORY ? uint64_t(job.ProcessMemoryLimit) : kNoMemoryLimit,
                  flags & JOB_OBJECT_LIMIT_JOB_MEMORY ? uint64_t(job.JobMemoryLimit) : kNoMemoryLimit);
}

}  // namespace

uint64_t defaultMemoryLimit(const std::filesystem::path&) {
  MEMORYSTATUSEX machine{};
  machine.dwLength = sizeof machine;
  const uint64_t all = ::GlobalMemoryStatusEx(&machine) ? machine.ullTotalPhys : 4ULL << 30;
  return std::min(all, limitOfJob()) / 4 * 3;
}

uint64_t memoryTaken() {
  PROCESS_MEMORY_COUNTERS counters{};
  return ::GetProcessMemoryInfo(::GetCurrentProcess(), &counters, sizeof counters) ? counters.PagefileUsage : 0;
}

uint64_t memoryAllowed() { return limitOfJob(); }

}  // namespace cloudbake
