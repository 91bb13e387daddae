module feap_arrays
  !! FEAP's arrays of nodes and elements: what the mesh commands and the search write and read there.
  use kinds, only: wp
  use extraction_mesh, only: whole_number
  use feap_host, only: fail
  implicit none
  private
  public :: count_mesh, is_counting, first_free, space_dimension, store_node, store_element, store_nodes_of, &
    positions, renew_profile

contains

  logical function is_counting()
    !! Whether FEAP makes its first pass over the deck, in which it only counts.
    include 'umac1.h'

    is_counting = ucount
  end function is_counting

  subroutine first_free(node, element)
    integer, intent(out) :: node, element          !! least numbers that *NOD and *ELE leave
    include 'dstars.h'

    node = starnd + 1
    element = starel + 1
  end subroutine first_free

  subroutine count_mesh(node, element, nodes_of_element)
    !! Tell FEAP in its counting pass how far the numbers go and how many nodes an element has.
    integer, intent(in) :: node, element, nodes_of_element
    include 'umac1.h'
    include 'cdata.h'
    include 'dstars.h'

    unumnd = node - starnd
    unumel = element - starel
    nen = max(nen, nodes_of_element)
  end subroutine count_mesh

  integer function space_dimension()
    include 'sdata.h'

    space_dimension = ndm
  end function space_dimension

  subroutine store_node(node, x)
    integer, intent(in) :: node
    real(wp), intent(in) :: x(:)                   !! at least (ndm) [length]
    include 'cdata.h'
    include 'sdata.h'
    include 'pointer.h'
    include 'comblk.h'
    integer :: i

    if (node > numnp) call fail('node '//whole_number(node)//': the control record announces '//whole_number(numnp)// &
      ' nodes. Write 0 there, then FEAP counts')
    do i = 1, ndm
      hr(np(43) + ndm*(node - 1) + i - 1) = x(i)
    end do
    mr(np(190) + node - 1) = 0
  end subroutine store_node

  subroutine store_element(element, material, nodes)
    integer, intent(in) :: element, material
    integer, intent(in) :: nodes(:)                !! (nen of the element)
    include 'cdata.h'
    include 'sdata.h'
    include 'pointer.h'
    include 'comblk.h'
    include 'region.h'
    integer(8) :: at
    integer :: i
    logical :: changed

    if (element > numel) call fail('element '//whole_number(element)//': the control record announces '// &
      whole_number(numel)//' elements. Write 0 there, then FEAP counts')
    call store_nodes_of(element, nodes, changed)
    at = np(33) + int(nen1, 8)*(element - 1) - 1
    do i = nen + 1, nen1 - 2
      mr(at + i) = 0
    end do
    mr(at + nen1 - 1) = nreg
    mr(at + nen1) = material
  end subroutine store_element

  subroutine store_nodes_of(element, nodes, changed)
    integer, intent(in) :: element
    integer, intent(in) :: nodes(:)
    logical, intent(out) :: changed                !! the element had other nodes before
    include 'cdata.h'
    include 'sdata.h'
    include 'pointer.h'
    include 'comblk.h'
    integer(8) :: at
    integer :: i, node

    if (size(nodes) > nen) call fail('element '//whole_number(element)//' has '//whole_number(size(nodes))// &
      ' nodes, the mesh has room for '//whole_number(nen)//' of an element. Give the larger number as nen on the control record')
    at = np(33) + int(nen1, 8)*(element - 1) - 1
    changed = .false.
    do i = 1, nen
      node = 0
      if (i <= size(nodes)) node = nodes(i)
      changed = changed .or. mr(at + i) /= node
      mr(at + i) = node
    end do
  end subroutine store_nodes_of

  subroutine positions(x_ref, x)
    !! Nodes now: reference coordinates and total displacements.
    real(wp), allocatable, intent(inout) :: x_ref(:, :), x(:, :)   !! (ndm,numnp) [length]
    include 'cdata.h'
    include 'sdata.h'
    include 'pointer.h'
    include 'comblk.h'
    integer :: i, n

    if (allocated(x)) then
      if (size(x, 2) /= numnp) deallocate (x, x_ref)
    end if
    if (.not. allocated(x)) allocate (x(ndm, numnp), x_ref(ndm, numnp))
    do n = 1, numnp
      do i = 1, ndm
        x_ref(i, n) = hr(np(43) + ndm*(n - 1) + i - 1)
        x(i, n) = x_ref(i, n) + hr(np(40) + ndf*(n - 1) + i - 1)
      end do
    end do
  end subroutine positions

  subroutine renew_profile()
    !! The equations keep their numbers, their columns get new heights.
    include 'pointer.h'
    include 'comblk.h'
    external :: profil

    call profil(mr(np(21)), mr(np(34)), mr(np(31)), mr(np(33)), 2, .false.)
  end subroutine renew_profile
end module feap_arrays
