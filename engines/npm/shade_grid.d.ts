/**
 * The frame in which a box of the world fits: rows that take a point of the world, with 1 as fourth, to coordinates of nodes.
 * @param {{ low: Vec3, high: Vec3, cloud_size: number }} extent @param {Vec3} light @param {Vec3} wind @returns {ShadeFrame}
 */
export function shadeFrame({ low, high, cloud_size }: {
    low: Vec3;
    high: Vec3;
    cloud_size: number;
}, light: Vec3, wind: Vec3): ShadeFrame;
export class ShadeGrid {
    /** @param {ShadeFrame} frame @param {ShadeCloud[]} clouds @param {Vec3} light */
    constructor(frame: ShadeFrame, clouds: ShadeCloud[], light: Vec3);
    frame: ShadeFrame;
    light: Vec3;
    steps: Int32Array<ArrayBuffer>;
    columns: {
        first: any;
        count: any;
        depths: Float64Array<ArrayBuffer>;
        enters: any[];
        leaves: any[];
    }[];
    /** @returns {Vec3} */
    place(point: any): Vec3;
    nodesAround(low: any, high: any): {
        first: any;
        count: any;
    };
    nodesOf(points: any): {
        first: any;
        count: any;
    };
    columnsOf(cloud: any): {
        first: any;
        count: any;
        depths: Float64Array<ArrayBuffer>;
        enters: any[];
        leaves: any[];
    };
    add({ first, count, depths, enters, leaves }: {
        first: any;
        count: any;
        depths: any;
        enters: any;
        leaves: any;
    }): void;
    /**
     * The shares of the light at the nodes `around`, past all clouds but one.
     * @param {{ first: number[], count: number[] }} around @param {number} [own] the number of that cloud
     */
    sharesAround({ first, count }: {
        first: number[];
        count: number[];
    }, own?: number): Float32Array<ArrayBuffer>;
    /** @param {number} own the number of a cloud; its block. */
    pastOthers(own: number): {
        first: any;
        count: any;
        shares: Float32Array<ArrayBuffer>;
    };
    get pastAll(): {
        shares: Float32Array<ArrayBuffer>;
        first: number[];
        count: number[];
    };
    multiply({ first, count, shares: nodes }: {
        first: any;
        count: any;
        shares: any;
    }, points: any, begin: any, number: any, shares: any): void;
    /**
     * The blocks of clouds beside each other in one texture: its size, its numbers, and for each cloud what takes a place of the grid to the
     * texture's.
     * @param {{ first: number[], count: number[], own?: number }[]} blocks
     */
    packed(blocks: {
        first: number[];
        count: number[];
        own?: number;
    }[]): {
        size: number[];
        numbers: Float32Array<ArrayBuffer>;
        shifts: Float32Array<ArrayBuffer>;
    };
}
/**
 * A cloud of a grid: the shadow of its mesh, in a space that is made larger, turned about y and moved to the world; its light is turned
 * with it. `power`: of what it lets through.
 */
export type ShadeCloud = {
    shadow: import("./swept_shadow.js").SweptShadow;
    at: Vec3;
    scale: number;
    cosine: number;
    sine: number;
    power: number;
};
