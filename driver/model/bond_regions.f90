module bond_regions
  !! Which part of a cohesive interface is bonded from the start: lines of a CONTact data set,
  !!
  !!     BONDed   surface | BOX x1 x2 y1 y2 [z1 z2]
  !!     UNBOnded surface | BOX x1 x2 y1 y2 [z1 z2]
  !!
  !! A Gauss point of the slave surface is bonded if it lies in one of the BONDed parts (everywhere, if there is no such
  !! line) and in none of the UNBOnded ones. A box decides by the reference place of the Gauss point, not by elements; a
  !! surface is a part of the slave surface.
  use kinds, only: wp
  use messages, only: message_log, quoted, name_hint, whole_text
  use deck_record, only: record
  use model_data, only: model_type, bond_region, set_surface
  use model_sets, only: find_set, find_set_of_kind, set_names, as_surface
  implicit none (type, external)
  private
  public :: read_region, resolve_regions, is_bonded_at

  real(wp), parameter :: rounding = 1.0e-9_wp  !! of the size of a box: what lies on its bounds is inside

contains

  subroutine read_region(line, ndm, region, log)
    type(record), intent(in) :: line
    integer, intent(in) :: ndm                   !! space dimension
    type(bond_region), intent(out) :: region
    type(message_log), intent(inout) :: log
    real(wp) :: bounds(6), margin
    integer :: i

    region%at = line%at
    region%bonded = line%key(1) == 'bond'
    if (line%key(2) == 'box' .and. .not. line%is_quoted(2)) then
      if (line%count /= 2 + 2*ndm) then
        call line%add_error(log, 'a box has ' // whole_text(2*ndm) // ' bounds', 'Write ' // trim(line%word(1)) // &
          trim(merge(' BOX x1 x2 y1 y2      ', ' BOX x1 x2 y1 y2 z1 z2', ndm == 2)))
        return
      end if
      bounds = 0
      call line%numbers(3, bounds(1:2*ndm), log, 'bounds')
      do i = 1, ndm
        region%low(i) = min(bounds(2*i - 1), bounds(2*i))
        region%high(i) = max(bounds(2*i - 1), bounds(2*i))
      end do
      margin = rounding*maxval(region%high - region%low)
      region%low = region%low - margin
      region%high = region%high + margin
    else if (line%count /= 2) then
      call line%add_error(log, 'one surface or a box is expected', 'Write ' // trim(line%word(1)) // &
        ' surface, or BOX and its bounds')
    else
      call line%text(2, region%name, log, 'surface')
    end if
  end subroutine read_region

  subroutine resolve_regions(model, number, log)
    !! Find the surfaces of an interface's parts; they must belong to its slave surface.
    type(model_type), intent(inout) :: model
    integer, intent(in) :: number                !! index into model%interfaces
    type(message_log), intent(inout) :: log
    integer :: r, set, slave

    slave = model%interfaces(number)%slave
    do r = 1, size(model%interfaces(number)%regions)
      associate (region => model%interfaces(number)%regions(r))
        if (.not. allocated(region%name)) cycle
        set = find_set_of_kind(model, region%name, set_surface)
        if (set == 0) set = find_set(model, region%name)
        if (set > 0) call as_surface(model, set)
        region%set = set
        if (set == 0) then
          call log%add_error(region%at, 'CONTact', 'there is no surface ' // quoted(region%name), &
            name_hint(region%name, set_names(model, set_surface), 'surfaces'))
        else if (slave > 0) then
          if (.not. is_part(model, set, slave)) call log%add_error(region%at, 'CONTact', 'the surface ' // &
            quoted(region%name) // ' is not a part of the slave surface ' // quoted(model%sets(slave)%name), &
            'Make a set of some of its elements and sides by SET name SURFace, or write BOX and bounds')
        end if
      end associate
    end do
  end subroutine resolve_regions

  pure logical function is_part(model, part, whole)
    type(model_type), intent(in) :: model
    integer, intent(in) :: part, whole           !! indices of surfaces
    integer :: i

    is_part = .true.
    do i = 1, size(model%sets(part)%items)
      is_part = is_part .and. any(model%sets(whole)%items == model%sets(part)%items(i) &
        .and. model%sets(whole)%sides == model%sets(part)%sides(i))
    end do
  end function is_part

  pure logical function is_bonded_at(model, regions, x, element, side) result(bonded)
    !! Whether the regions bond a point.
    type(model_type), intent(in) :: model
    type(bond_region), intent(in) :: regions(:)
    real(wp), intent(in) :: x(:)                 !! its reference position [length]
    integer, intent(in) :: element, side         !! its slave facet
    integer :: r

    bonded = .not. any(regions%bonded)
    do r = 1, size(regions)
      if (regions(r)%bonded) bonded = bonded .or. is_inside(model, regions(r), x, element, side)
    end do
    do r = 1, size(regions)
      if (.not. regions(r)%bonded) bonded = bonded .and. .not. is_inside(model, regions(r), x, element, side)
    end do
  end function is_bonded_at

  pure logical function is_inside(model, region, x, element, side)
    type(model_type), intent(in) :: model
    type(bond_region), intent(in) :: region
    real(wp), intent(in) :: x(:)
    integer, intent(in) :: element, side

    if (region%set > 0) then
      is_inside = any(model%sets(region%set)%items == element .and. model%sets(region%set)%sides == side)
    else
      is_inside = all(x >= region%low(1:size(x)) .and. x <= region%high(1:size(x)))
    end if
  end function is_inside
end module bond_regions
