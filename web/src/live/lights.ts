import type { Colour, DeviceLight, GroupLight, Light } from "../api/types";

const ORDER: Colour[] = ["grey", "green", "amber", "red"];

/** The groups with some devices' lights replaced; a group shows the worst of its devices. */
export function withLights(
  groups: GroupLight[],
  changed: Record<string, DeviceLight>,
): GroupLight[] {
  return groups.map((group) => {
    const devices = group.devices.map(
      (device) => changed[fullName(group.group, device.device)] ?? device,
    );
    if (devices.every((device, index) => device === group.devices[index])) return group;
    return { ...group, devices, light: worst(devices.map((device) => device.light)) };
  });
}

export function fullName(group: string, device: string): string {
  return device ? `${group}-${device}` : group;
}

export function worst(lights: Light[]): Light {
  const colour = lights.reduce<Colour>(
    (found, light) => (ORDER.indexOf(light.colour) > ORDER.indexOf(found) ? light.colour : found),
    "grey",
  );
  return { colour, blinks: lights.some((light) => light.blinks) };
}

export const LIGHT_WORDS: Record<Colour, string> = {
  green: "running as learned",
  amber: "needs a look",
  red: "fault",
  grey: "no data",
};
